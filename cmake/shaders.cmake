# GLSL -> SPIR-V words in the build tree, which C++ includes into an array: #include "<path>.inc".
find_program(GLSLC glslc REQUIRED)

# throng_add_shaders(target file...): files relative to src/.
function(throng_add_shaders target)
  foreach(shader IN LISTS ARGN)
    set(source ${PROJECT_SOURCE_DIR}/src/${shader})
    set(output ${PROJECT_BINARY_DIR}/shaders/${shader}.inc)
    get_filename_component(folder ${output} DIRECTORY)
    file(MAKE_DIRECTORY ${folder})
    add_custom_command(
      OUTPUT ${output}
      COMMAND ${GLSLC} --target-env=vulkan1.3 -O -Werror -mfmt=num -I ${PROJECT_SOURCE_DIR}/src -MD -MF ${output}.d -o ${output} ${source}
      DEPENDS ${source}
      DEPFILE ${output}.d
      COMMENT "Compiling shader ${shader}"
      VERBATIM)
    target_sources(${target} PRIVATE ${output})
  endforeach()
  target_include_directories(${target} PRIVATE ${PROJECT_BINARY_DIR}/shaders)
endfunction()
