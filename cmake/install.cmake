# cmake --install: the shared library, its headers, and a package for find_package(throng).
include(CMakePackageConfigHelpers)

install(TARGETS throng EXPORT throng-targets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/throng DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/throng)
install(EXPORT throng-targets NAMESPACE throng:: DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/throng-config-version.cmake COMPATIBILITY SameMinorVersion)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/throng-config.cmake.in
  ${PROJECT_BINARY_DIR}/throng-config.cmake
  INSTALL_DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/throng-config.cmake ${PROJECT_BINARY_DIR}/throng-config-version.cmake DESTINATION
  ${package_dir})
