# GLSL -> SPIR-V words in the build tree, which C++ includes into an array: #include "<output>".
find_program(GLSLC glslc REQUIRED)

# throng_add_shader(target shader output defines...): shader relative to src/ or absolute, output to the folder of
# shaders in the build tree.
function(throng_add_shader target shader output_name)
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
endfunction()

# throng_add_kernel(target kernel [SOFTWARE]): a compute shader, relative to src/ and without its ending, and with
# SOFTWARE its variant for software devices, as the KernelCode kernels::<file> in <kernel>.kernel.h.
function(throng_add_kernel target kernel)
  cmake_path(GET kernel FILENAME name)
  throng_add_shader(${target} ${kernel}.comp ${kernel}.comp.inc)
  set(arrays "inline constexpr uint32_t ${name}_plain[] = {\n#include \"${kernel}.comp.inc\"\n};\n")
  set(software ${name}_plain)
  if(ARGN)
    throng_add_shader(${target} ${kernel}.comp ${kernel}.software.inc GPU_SOFTWARE)
    set(software ${name}_software)
    string(APPEND arrays "inline constexpr uint32_t ${software}[] = {\n#include \"${kernel}.software.inc\"\n};\n")
  endif()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/shaders/${kernel}.kernel.h @ONLY CONTENT
"#pragma once
#include \"gpu/kernel_code.h\"
namespace throng::kernels {
${arrays}inline constexpr KernelCode ${name}{\"${name}\", ${name}_plain, ${software}};
}
")
endfunction()
