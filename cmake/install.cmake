# What cmake --install installs, all of it or one part with --component: Runtime, the library; Development, the headers
# and what CMake and pkg-config read; Tools, the command line (tools/CMakeLists.txt); Documentation, with the schema
# that editors read.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/throng)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
set(doc_dir ${CMAKE_INSTALL_DOCDIR})
if(NOT PROJECT_IS_TOP_LEVEL)  # CMAKE_INSTALL_DOCDIR may be the parent project's
  set(doc_dir ${CMAKE_INSTALL_DATAROOTDIR}/doc/throng)
endif()

install(TARGETS throng EXPORT throng-targets LIBRARY COMPONENT Runtime NAMELINK_COMPONENT Development)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/throng DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT Development)
install(EXPORT throng-targets NAMESPACE throng:: DESTINATION ${package_dir} COMPONENT Development)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/throng-config-version.cmake COMPATIBILITY SameMajorVersion)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/throng-config.cmake.in
  ${PROJECT_BINARY_DIR}/throng-config.cmake
  INSTALL_DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/throng-config.cmake ${PROJECT_BINARY_DIR}/throng-config-version.cmake
  DESTINATION ${package_dir} COMPONENT Development)
GNUInstallDirs_get_absolute_install_dir(full_pkgconfig_dir pkgconfig_dir LIBDIR)
file(RELATIVE_PATH prefix_from_pkgconfig ${full_pkgconfig_dir} ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH include_from_pkgconfig ${full_pkgconfig_dir} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
file(RELATIVE_PATH lib_from_pkgconfig ${full_pkgconfig_dir} ${CMAKE_INSTALL_FULL_LIBDIR})
configure_file(${PROJECT_SOURCE_DIR}/cmake/throng.pc.in ${PROJECT_BINARY_DIR}/throng.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/throng.pc DESTINATION ${pkgconfig_dir} COMPONENT Development)

install(FILES ${PROJECT_SOURCE_DIR}/docs/controller.schema.json DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/throng
  COMPONENT Documentation)
# The documents, and what they link to: tests/links.py follows all links there.
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md
  DESTINATION ${doc_dir} COMPONENT Documentation)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${doc_dir} COMPONENT Documentation)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${doc_dir} COMPONENT Documentation)
install(FILES ${PROJECT_SOURCE_DIR}/bench/README.md DESTINATION ${doc_dir}/bench COMPONENT Documentation)
GNUInstallDirs_get_absolute_install_dir(full_doc_dir doc_dir DOCDIR)
file(RELATIVE_PATH include_from_doc ${full_doc_dir} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
install(CODE "set(doc_dir ${doc_dir})
  cmake_path(ABSOLUTE_PATH doc_dir BASE_DIRECTORY \${CMAKE_INSTALL_PREFIX})
  file(CREATE_LINK ${include_from_doc} \$ENV{DESTDIR}\${doc_dir}/include SYMBOLIC)" COMPONENT Documentation)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${doc_dir} COMPONENT Runtime)
