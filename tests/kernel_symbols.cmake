# A kernel for one instruction set (src/native/kernel_*.cpp) must export exactly one function, so that the linker cannot
# use its code in place of another file's. Checks `OBJECTS` (separated by '|') with `NM`.
string(REPLACE "|" ";" OBJECTS "${OBJECTS}")
if(NOT OBJECTS)
  message(FATAL_ERROR "there is no kernel")
endif()
foreach(object IN LISTS OBJECTS)
  execute_process(COMMAND ${NM} --defined-only --extern-only ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(STRIP "${symbols}" symbols)
  if(NOT symbols MATCHES "^[0-9a-f]+ T [A-Za-z0-9_]*kernel_[a-z0-9]+Ev$")
    message(FATAL_ERROR "${object} defines more than its kernel:\n${symbols}")
  endif()
endforeach()
