# Compiles GLSL to SPIR-V words in the build tree. C++ includes them into an array: #include "<output>".
find_program(GLSLC glslc REQUIRED)

# throng_add_shader(target shader output defines...): `shader` is relative to src/ or absolute, `output` is relative to
# the build tree's folder of shaders. The target throng_shaders compiles the library's shaders, unless the folder
# THRONG_COMPILED_SHADERS has them already.
function(throng_add_shader target shader output_name)
  cmake_path(COMPARE ${CMAKE_CURRENT_SOURCE_DIR} EQUAL ${PROJECT_SOURCE_DIR} of_the_library)
  if(of_the_library AND THRONG_COMPILED_SHADERS)
    if(NOT EXISTS ${THRONG_COMPILED_SHADERS}/${output_name})
      message(FATAL_ERROR "${THRONG_COMPILED_SHADERS} lacks ${output_name}: build throng_shaders there first "
        "(./run sanitize does), or set THRONG_COMPILED_SHADERS to nothing")
    endif()
    return()
  endif()
  cmake_path(ABSOLUTE_PATH shader BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/src OUTPUT_VARIABLE source)
  set(output ${PROJECT_BINARY_DIR}/shaders/${output_name})
  get_filename_component(folder ${output} DIRECTORY)
  file(MAKE_DIRECTORY ${folder})
  set(defines ${ARGN})
  list(TRANSFORM defines PREPEND -D)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${GLSLC} -std=460 --target-env=vulkan1.3 -O -Werror -mfmt=num ${defines} -I ${PROJECT_SOURCE_DIR}/src
    -I ${THRONG_GENERATED_DIR} -MD -MF ${output}.d -o ${output} ${source}
    DEPENDS ${source}
    DEPFILE ${output}.d
    COMMENT "Compiling shader ${output_name}"
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
  if(of_the_library)
    set_property(GLOBAL APPEND PROPERTY THRONG_SHADERS ${output})
  endif()
endfunction()

# throng_add_native(target shader name defines...): compiles a compute shader, relative to src/, as C++, to the
# NativeKernel native::<name> (gpu/native_text.h). As on a device, each operation is rounded once and literals are
# floats. Buffers are words that shaders see as several types, so the compiler must not draw conclusions from types.
# GLSL converts numbers, shadows names, and has functions that not every kernel uses, so these warnings are off. Its
# constructors are C++20's parenthesized aggregate initialization, which GCC has since version 10 and Clang since 16.
set(native_options -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-strict-aliasing -Wno-conversion -Wno-shadow
  -Wno-unused-function)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND native_options -fsingle-precision-constant -Wno-maybe-uninitialized)
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  list(APPEND native_options -Xclang -cl-single-precision-constant)
endif()
if(THRONG_SANITIZE)  # the target itself may be compiled with -O0
  list(APPEND native_options -O1)
elseif(CMAKE_BUILD_TYPE STREQUAL Release)
  list(APPEND native_options -O3)
endif()
function(throng_add_native target shader name)
  set(source ${PROJECT_BINARY_DIR}/native/${name}.cpp)
  list(TRANSFORM THRONG_IO_HEADERS REPLACE "(.+)" "#include \"\\1\"\n" OUTPUT_VARIABLE includes)
  set(defines ${ARGN})
  list(TRANSFORM defines REPLACE "(.+)" "#define \\1\n")
  string(CONCAT head "// ${shader} as C++: made by cmake/shaders.cmake.\n" ${defines} ${includes})
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT
"${head}#include \"gpu/native_text.h\"

namespace throng {
namespace io {
namespace {

struct Text : NativeText {
    using NativeText::NativeText;
#include \"${shader}\"
};

}  // namespace
}  // namespace io

namespace native {
extern const NativeKernel ${name};
const NativeKernel ${name} = io::native_kernel<io::Text>();
}  // namespace native
}  // namespace throng
")
  set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "${native_options}" SKIP_PRECOMPILE_HEADERS ON)
  target_sources(${target} PRIVATE ${source})
endfunction()

# throng_add_kernel(target kernel [SOFTWARE] [NATIVE]): compiles a compute shader, relative to src/ and without its
# extension, and defines it as the KernelCode kernels::<file> in <kernel>.kernel.h: with SOFTWARE also in its variant
# for software devices, with NATIVE also as C++.
function(throng_add_kernel target kernel)
  cmake_parse_arguments(with "SOFTWARE;NATIVE" "" "" ${ARGN})
  cmake_path(GET kernel FILENAME name)
  throng_add_shader(${target} ${kernel}.comp ${kernel}.comp.inc)
  set(arrays "inline constexpr uint32_t ${name}_plain[] = {\n#include \"${kernel}.comp.inc\"\n};\n")
  set(software ${name}_plain)
  if(with_SOFTWARE)
    throng_add_shader(${target} ${kernel}.comp ${kernel}.software.inc GPU_SOFTWARE)
    set(software ${name}_software)
    string(APPEND arrays "inline constexpr uint32_t ${software}[] = {\n#include \"${kernel}.software.inc\"\n};\n")
  endif()
  set(declaration "")
  set(native nullptr)
  if(with_NATIVE)
    throng_add_native(${target} ${kernel}.comp ${name})
    set(declaration "namespace throng::native {\nextern const NativeKernel ${name};\n}\n")
    set(native &native::${name})
  endif()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/shaders/${kernel}.kernel.h @ONLY CONTENT
"#pragma once
#include \"gpu/kernel_code.h\"
${declaration}namespace throng::kernels {
${arrays}inline constexpr KernelCode ${name}{\"${name}\", ${name}_plain, ${software}, ${native}};
}
")
endfunction()
