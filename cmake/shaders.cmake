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
    COMMAND ${GLSLC} --target-env=vulkan1.3 -O -Werror -mfmt=num ${defines} -I ${PROJECT_SOURCE_DIR}/src -I
    ${THRONG_GENERATED_DIR} -MD -MF ${output}.d -o ${output} ${source}
    DEPENDS ${source}
    DEPFILE ${output}.d
    COMMENT "Compiling shader ${output_name}"
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()

# throng_add_library_shader(target shader [variants...]): into the library, as throng::shaders::<name> of gpu/shader.h.
# `software` variants move transforms as 64-bit words, for software devices (gpu/stored.glsl).
function(throng_add_library_shader target shader)
  cmake_path(GET shader STEM name)
  cmake_path(GET shader EXTENSION LAST_ONLY kind)
  if(NOT kind STREQUAL .comp)
    string(REPLACE "." "_" kind ${kind})
    string(APPEND name ${kind})
  endif()
  throng_add_shader(${target} ${shader} ${shader}.inc)
  set(arrays "constexpr uint32_t plain[] = {\n#include \"${shader}.inc\"\n};\n")
  set(software_words "{}")
  if("software" IN_LIST ARGN)
    throng_add_shader(${target} ${shader} ${shader}.software.inc GPU_SOFTWARE)
    string(APPEND arrays "constexpr uint32_t software[] = {\n#include \"${shader}.software.inc\"\n};\n")
    set(software_words software)
  endif()
  set(source ${PROJECT_BINARY_DIR}/shaders/${shader}.cpp)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT
    "#include \"shaders.h\"\n\nnamespace throng::shaders {\nnamespace {\n\n${arrays}\n}  // namespace
const Shader ${name}{plain, ${software_words}};\n}  // namespace throng::shaders\n")
  target_sources(${target} PRIVATE ${source})
  set_property(GLOBAL APPEND PROPERTY THRONG_SHADERS ${name})
endfunction()

# shaders.h, after the last throng_add_library_shader().
function(throng_declare_shaders)
  get_property(names GLOBAL PROPERTY THRONG_SHADERS)
  list(JOIN names ", " names)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/shaders/shaders.h @ONLY CONTENT
    "#pragma once\n\n#include \"gpu/shader.h\"\n\nnamespace throng::shaders {\n\nextern const Shader ${names};\n
}  // namespace throng::shaders\n")
endfunction()
