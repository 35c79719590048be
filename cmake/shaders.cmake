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
