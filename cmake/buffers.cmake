# Reads the table of docs/buffers.md and makes three things of it: gpu/buffers_io.h, the number of every buffer that
# kernels read or write, for C++ and GLSL; the buffers' names, for messages; and lists of the buffers that outlive an
# update, from the words in the table's last column.
set(buffers_table ${PROJECT_SOURCE_DIR}/docs/buffers.md)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${buffers_table})
set(THRONG_GENERATED_DIR ${PROJECT_BINARY_DIR}/generated)

file(READ ${buffers_table} text)
# CMake splits lists at semicolons, but not inside square brackets.
string(REPLACE ";" "@semicolon@" text "${text}")
string(REPLACE "[" "@open@" text "${text}")
string(REPLACE "]" "@close@" text "${text}")
string(REGEX MATCHALL "\n\\| `[^\n]*" lines "${text}")
set(constants "")
set(names "")
set(uses saved shown scattered)
foreach(use IN LISTS uses)
  set(${use} "")
endforeach()
set(count 0)
foreach(line IN LISTS lines)
  if(NOT line MATCHES "^\n\\| `([a-z ]+)` \\|[^|]+\\|[^|]+\\|[^|]+\\|[^|]+\\|[^|]+\\| ([^|]+) \\|$")
    message(FATAL_ERROR "docs/buffers.md: a row must have seven cells, and a name of small letters in the first: "
      "${line}")
  endif()
  set(name "${CMAKE_MATCH_1}")
  string(REPLACE ", " ";" uses_of_it "${CMAKE_MATCH_2}")
  string(APPEND names "\"${name}\",\n")
  string(REPLACE " " "@word@" words "@word@${name}")
  foreach(letter a b c d e f g h i j k l m n o p q r s t u v w x y z)
    string(TOUPPER ${letter} capital)
    string(REPLACE "@word@${letter}" ${capital} words "${words}")
  endforeach()
  string(APPEND constants "THRONG_IO_CONSTANT k${words}Buffer = ${count};\n")
  foreach(use IN LISTS uses_of_it)
    if(use IN_LIST uses)
      string(APPEND ${use} "    io::k${words}Buffer,\n")
    elseif(NOT use STREQUAL "–")
      message(FATAL_ERROR "docs/buffers.md: the last cell of `${name}` has ${use}; there are ${uses}")
    endif()
  endforeach()
  math(EXPR count "${count} + 1")
endforeach()
file(CONFIGURE OUTPUT ${THRONG_GENERATED_DIR}/gpu/buffers_io.h @ONLY CONTENT
"// One number for each buffer that throng's kernels read or write: its binding in every shader, its place in a
// BufferTable. Made from docs/buffers.md by cmake/buffers.cmake.
#ifndef THRONG_BUFFERS_IO_H
#define THRONG_BUFFERS_IO_H
#include \"gpu/shader_types.h\"
THRONG_IO_BEGIN

${constants}THRONG_IO_CONSTANT kBufferCount = ${count};

THRONG_IO_END
#endif
")
file(CONFIGURE OUTPUT ${THRONG_GENERATED_DIR}/gpu/buffer_names.inc @ONLY CONTENT "${names}")
file(CONFIGURE OUTPUT ${THRONG_GENERATED_DIR}/gpu/buffer_uses.h @ONLY CONTENT
"// Buffers of a batch that outlive an update, from the last column of docs/buffers.md by cmake/buffers.cmake.
#pragma once

#include \"gpu/buffers_io.h\"

#include <array>

namespace throng {

inline constexpr std::array kSavedBuffers{
${saved}};
inline constexpr std::array kShownBuffers{
${shown}};
inline constexpr std::array kScatteredBuffers{
${scattered}};

}  // namespace throng
")
