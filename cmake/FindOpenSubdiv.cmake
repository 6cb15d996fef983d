# OpenSubdiv's CPU library as OpenSubdiv::CPU, found through its header and library: the package's own
# CMake config names a static library that Debian does not ship.
find_path(OpenSubdiv_INCLUDE_DIR opensubdiv/far/topologyRefiner.h)
find_library(OpenSubdiv_LIBRARY osdCPU)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenSubdiv DEFAULT_MSG OpenSubdiv_LIBRARY OpenSubdiv_INCLUDE_DIR)
mark_as_advanced(OpenSubdiv_INCLUDE_DIR OpenSubdiv_LIBRARY)
if(OpenSubdiv_FOUND AND NOT TARGET OpenSubdiv::CPU)
  add_library(OpenSubdiv::CPU INTERFACE IMPORTED)
  target_include_directories(OpenSubdiv::CPU SYSTEM INTERFACE ${OpenSubdiv_INCLUDE_DIR})
  target_link_libraries(OpenSubdiv::CPU INTERFACE ${OpenSubdiv_LIBRARY})
endif()
