# Installs the libraries, their headers, the command and what find_package(meshprep) reads.
include(CMakePackageConfigHelpers)
set(meshprep_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/meshprep)
# One export per library, because each has a namespace of its own: prep::prep and rast::rast.
install(TARGETS prep_images prep_readers EXPORT prepTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(library IN ITEMS prep rast)
  install(TARGETS ${library} EXPORT ${library}Targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT ${library}Targets NAMESPACE ${library}:: DESTINATION ${meshprep_config_dir})
endforeach()
install(DIRECTORY libprep/include/ librast/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
configure_package_config_file(cmake/meshprepConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/meshprepConfig.cmake INSTALL_DESTINATION ${meshprep_config_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/meshprepConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/meshprepConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/meshprepConfigVersion.cmake cmake/MeshprepDependencies.cmake
  cmake/FindOpenImageIOLibrary.cmake cmake/FindCGALHeaders.cmake cmake/FindOpenSubdiv.cmake
  DESTINATION ${meshprep_config_dir})
install(FILES LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR})
