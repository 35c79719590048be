# Installs a build into a separate folder, builds the consumer against it in each way that docs/library.md names, and
# runs the consumer and the command line from there.
# cmake -D BUILD=… -D WORK=… -D CHARACTER=… -D GENERATOR=… -D COMPILER=… -D FLAGS=… -D VERSION=… -D LIBDIR=…
#   -D VULKAN_HEADERS=… -P run.cmake
file(REMOVE_RECURSE ${WORK})
set(prefix ${WORK}/prefix)
unset(ENV{LD_LIBRARY_PATH})
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})

# build_consumer(folder argument...): builds it with CMake
set(configure ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${COMPILER}
  -D CMAKE_PREFIX_PATH=${prefix})
function(build_consumer folder)
  run(${configure} -B ${WORK}/${folder} ${ARGN})
  run(${CMAKE_COMMAND} --build ${WORK}/${folder})
  run(${WORK}/${folder}/consumer ${CHARACTER})
endfunction()

# Accepts any version from this one up to, but not including, the next major one.
string(REGEX MATCH "^([0-9]+)\\.[0-9]+" minor_version ${VERSION})
math(EXPR next_major "${CMAKE_MATCH_1} + 1")
build_consumer(versions -D THRONG_VERSIONS=${minor_version}...<${next_major} -D CMAKE_CXX_FLAGS=${FLAGS})
find_package(throng ${next_major} QUIET NO_DEFAULT_PATH PATHS ${prefix})
if(throng_FOUND OR NOT throng_CONSIDERED_VERSIONS STREQUAL VERSION)
  message(FATAL_ERROR "throng ${next_major} found where ${VERSION} is installed (${throng_CONSIDERED_VERSIONS})")
endif()

# Vulkan headers outside /usr/include, which may have others too. The macro marks these as the ones to use.
file(COPY ${VULKAN_HEADERS}/vulkan ${VULKAN_HEADERS}/vk_video DESTINATION ${WORK}/sdk/include)
file(APPEND ${WORK}/sdk/include/vulkan/vulkan_core.h "#define HEADERS_OF_SDK\n")
set(ENV{VULKAN_SDK} ${WORK}/sdk)
build_consumer(sdk -D THRONG_VERSIONS=${minor_version} -D "CMAKE_CXX_FLAGS=${FLAGS} -D NEEDS_HEADERS_OF_SDK")
unset(ENV{VULKAN_SDK})

# Without any Vulkan headers.
execute_process(COMMAND ${configure} -B ${WORK}/no_vulkan -D CMAKE_DISABLE_FIND_PACKAGE_Vulkan=ON
  -D CMAKE_DISABLE_FIND_PACKAGE_VulkanHeaders=ON OUTPUT_QUIET RESULT_VARIABLE failed ERROR_VARIABLE errors)
if(NOT failed OR NOT errors MATCHES "throng's headers need Vulkan's")
  message(FATAL_ERROR "what to install is not said: ${errors}")
endif()

# The installed files may be moved. With pkg-config, and without linking Vulkan's loader.
file(RENAME ${prefix} ${WORK}/moved)
set(prefix ${WORK}/moved)
set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
execute_process(COMMAND pkg-config --cflags --libs throng OUTPUT_VARIABLE found COMMAND_ERROR_IS_FATAL ANY)
if(found MATCHES "-lvulkan")
  message(FATAL_ERROR "throng.pc links Vulkan's loader: ${found}")
endif()
separate_arguments(flags UNIX_COMMAND "${FLAGS} ${found}")
run(${COMPILER} -std=c++20 -o ${WORK}/by_pkg_config ${CMAKE_CURRENT_LIST_DIR}/main.cpp ${flags}
  -Wl,-rpath,${prefix}/${LIBDIR})
run(${WORK}/by_pkg_config ${CHARACTER})

# The command line, its two other programs, and the installed documents.
execute_process(COMMAND ${prefix}/bin/throng --version OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE
  COMMAND_ERROR_IS_FATAL ANY)
if(NOT version STREQUAL VERSION)
  message(FATAL_ERROR "throng --version is '${version}', not ${VERSION}")
endif()
run(${prefix}/bin/throng info ${CHARACTER})
run(${prefix}/bin/throng bench --help)
run(${prefix}/bin/throng view --help)
run(python3 ${CMAKE_CURRENT_LIST_DIR}/../links.py ${prefix}/share/doc/throng)
run(${CMAKE_COMMAND} -S ${prefix}/share/doc/throng/examples -B ${WORK}/examples -G ${GENERATOR}
  -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${FLAGS} -D CMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${WORK}/examples --target swarm)  # which has a shader too
foreach(file throng/controller.schema.json doc/throng/LICENSE doc/throng/README.md doc/throng/docs/library.md)
  if(NOT EXISTS ${prefix}/share/${file})
    message(FATAL_ERROR "not installed: share/${file}")
  endif()
endforeach()
