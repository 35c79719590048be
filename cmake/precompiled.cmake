# The standard library's headers that most files read, compiled once: 0.7 s of processor time of every file. With GCC
# alone; other compilers want a precompiled header's flags and definitions to be the same in all that use it.
option(THRONG_QUICK_BUILD "Precompile the standard headers; compile what seldom runs with -O1" ON)
set(THRONG_STANDARD_HEADERS <algorithm> <array> <cmath> <cstdint> <cstdio> <cstring> <filesystem> <functional>
  <map> <memory> <optional> <span> <string> <string_view> <variant> <vector>)

# ccache keeps nothing that is compiled with a precompiled header, unless it is told that it may (its manual,
# "Precompiled headers").
if(THRONG_QUICK_BUILD AND CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache$")
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

# throng_add_precompiled(name kind header...): what throng_precompile() takes. `kind` is -fPIC, for libraries, or -fPIE,
# for programs. It has throng_options' flags, but no definitions: those who use it may not lack any.
function(throng_add_precompiled name kind)
  if(NOT THRONG_QUICK_BUILD OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    return()
  endif()
  file(CONFIGURE OUTPUT ${name}.cpp CONTENT "// CMake makes precompiled headers for sources: for this one.\n")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${name} PRIVATE ${kind} $<TARGET_PROPERTY:throng_options,INTERFACE_COMPILE_OPTIONS>)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

# The sources of `target` begin with the headers of `precompiled`.
function(throng_precompile target precompiled)
  if(NOT TARGET ${precompiled})
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${precompiled})
  # The first is what ccache asks for. The others find false alarms in std::string where it is precompiled, as
  # -Wrestrict does anywhere (GCC bug 105329).
  target_compile_options(${target} PRIVATE -fpch-preprocess -Wno-array-bounds -Wno-stringop-overflow)
endfunction()
