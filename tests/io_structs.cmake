# Every struct of the *_io.h headers (cmake/io_structs.cmake), for gpu_test. io_structs.inc lists them with their
# members for C++. io_structs.comp has a buffer of each, whose layout the test reads from the SPIR-V.
list(TRANSFORM THRONG_IO_HEADERS REPLACE "(.+)" "#include \"\\1\"\n" OUTPUT_VARIABLE includes)
string(CONCAT includes ${includes})
set(in_cpp "")
set(buffers "")
set(number 0)
foreach(struct IN LISTS THRONG_IO_STRUCTS ITEMS Affine)
  string(APPEND buffers
    "layout(set = 0, binding = ${number}, std430) buffer Buffer${number} { ${struct} of_${number}[]; };\n")
  math(EXPR number "${number} + 1")
endforeach()
foreach(struct IN LISTS THRONG_IO_STRUCTS)
  list(TRANSFORM THRONG_IO_${struct} REPLACE "(.+)" "MEMBER(${struct}, \\1), " OUTPUT_VARIABLE members)
  string(CONCAT members ${members})
  string(APPEND in_cpp "{\"${struct}\", {sizeof(io::${struct}), {${members}}}},\n")
endforeach()
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/io_headers.inc @ONLY CONTENT "${includes}")
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/io_structs.inc @ONLY CONTENT "${in_cpp}")
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/io_structs.comp @ONLY CONTENT
  "#include \"gpu/affine.glsl\"\n${includes}${buffers}void main() {}\n")
