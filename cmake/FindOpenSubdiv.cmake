# OpenSubdiv's CPU library as OpenSubdiv::osdCPU: the package's own config names a static library
# that Debian does not ship.
find_path(OpenSubdiv_INCLUDE_DIR opensubdiv/version.h)
find_library(OpenSubdiv_LIBRARY osdCPU)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenSubdiv DEFAULT_MSG OpenSubdiv_LIBRARY OpenSubdiv_INCLUDE_DIR)
mark_as_advanced(OpenSubdiv_INCLUDE_DIR OpenSubdiv_LIBRARY)
if(OpenSubdiv_FOUND AND NOT TARGET OpenSubdiv::osdCPU)
  add_library(OpenSubdiv::osdCPU INTERFACE IMPORTED)
  target_include_directories(OpenSubdiv::osdCPU SYSTEM INTERFACE ${OpenSubdiv_INCLUDE_DIR})
  target_link_libraries(OpenSubdiv::osdCPU INTERFACE ${OpenSubdiv_LIBRARY})
endif()
