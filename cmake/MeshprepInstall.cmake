include(CMakePackageConfigHelpers)
install(TARGETS prep rast EXPORT meshprepTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY libprep/include/ librast/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
set(meshprep_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/meshprep)
install(EXPORT meshprepTargets DESTINATION ${meshprep_config_dir})
configure_package_config_file(cmake/meshprepConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/meshprepConfig.cmake INSTALL_DESTINATION ${meshprep_config_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/meshprepConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/meshprepConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/meshprepConfigVersion.cmake cmake/MeshprepDependencies.cmake
  cmake/FindOpenImageIOLibrary.cmake cmake/FindCGALHeaders.cmake
  cmake/FindOpenSubdiv.cmake
  DESTINATION ${meshprep_config_dir})
