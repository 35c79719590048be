# Makes builds faster. Packagers may not want it.
option(THRONG_QUICK_BUILD "Precompile headers, compile several files at a time and what seldom runs with -O1" ON)

# The standard library's headers that most files include, compiled once. This saves 0.7 s of processor time per file.
# Only for GCC and Clang: other compilers require that everything that uses a precompiled header has the same flags and
# definitions.
set(THRONG_STANDARD_HEADERS <algorithm> <array> <cmath> <cstdint> <cstdio> <cstring> <filesystem> <functional>
  <limits> <map> <memory> <mutex> <numeric> <optional> <span> <string> <string_view> <thread> <utility> <variant>
  <vector>)

# ccache does not cache what is compiled with a precompiled header unless it is told that it may ("Precompiled headers"
# in its manual).
if(THRONG_QUICK_BUILD AND CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache$")
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

# throng_add_precompiled(name kind [VOLK] header...): makes a target for throng_precompile(). `kind` is -fPIC for
# libraries or -fPIE for programs. The target has the flags and include folders of throng_options, and its definition
# only with VOLK: users of a precompiled header must have all of its definitions, and not all of them declare Vulkan's
# functions as pointers.
function(throng_add_precompiled name kind)
  if(NOT THRONG_QUICK_BUILD OR NOT CMAKE_CXX_COMPILER_ID MATCHES "^(GNU|Clang)$")
    return()
  endif()
  cmake_parse_arguments(PARSE_ARGV 2 precompiled "VOLK" "" "")
  file(CONFIGURE OUTPUT ${name}.cpp CONTENT "// CMake makes precompiled headers for sources: for this one.\n")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${name} PRIVATE ${kind} $<TARGET_PROPERTY:throng_options,INTERFACE_COMPILE_OPTIONS>)
  target_include_directories(${name} PRIVATE $<TARGET_PROPERTY:throng_options,INTERFACE_INCLUDE_DIRECTORIES>)
  if(precompiled_VOLK)
    target_compile_definitions(${name} PRIVATE $<TARGET_PROPERTY:throng_options,INTERFACE_COMPILE_DEFINITIONS>)
  endif()
  target_precompile_headers(${name} PRIVATE ${precompiled_UNPARSED_ARGUMENTS})
endfunction()

# Makes all sources of `target` begin with the headers of `precompiled`.
function(throng_precompile target precompiled)
  if(NOT TARGET ${precompiled})
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${precompiled})
  # ccache requires the first flag. The other two turn off false alarms in a precompiled std::string, like those of
  # -Wrestrict anywhere (GCC bug 105329).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess -Wno-array-bounds -Wno-stringop-overflow)
  endif()
endfunction()

# Compiles the sources of `target` eight at a time, since most of a file's compile time goes to headers and to the
# templates that it instantiates. Names in the files' unnamed namespaces must differ.
function(throng_compile_together target)
  if(THRONG_QUICK_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
endfunction()
