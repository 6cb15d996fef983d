# OpenImageIO as OpenImageIO::Library, found through its header and library: the package's own
# CMake config asks for Imath's Python module, which nothing here needs.
find_path(OpenImageIOLibrary_INCLUDE_DIR OpenImageIO/imageio.h)
find_library(OpenImageIOLibrary_LIBRARY OpenImageIO)
find_library(OpenImageIOLibrary_UTIL_LIBRARY OpenImageIO_Util)
find_path(OpenImageIOLibrary_IMATH_INCLUDE_DIR ImathVec.h PATH_SUFFIXES Imath)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIOLibrary DEFAULT_MSG OpenImageIOLibrary_LIBRARY
  OpenImageIOLibrary_UTIL_LIBRARY OpenImageIOLibrary_INCLUDE_DIR OpenImageIOLibrary_IMATH_INCLUDE_DIR)
mark_as_advanced(OpenImageIOLibrary_INCLUDE_DIR OpenImageIOLibrary_LIBRARY
  OpenImageIOLibrary_UTIL_LIBRARY OpenImageIOLibrary_IMATH_INCLUDE_DIR)
if(OpenImageIOLibrary_FOUND AND NOT TARGET OpenImageIO::Library)
  add_library(OpenImageIO::Library INTERFACE IMPORTED)
  target_include_directories(OpenImageIO::Library SYSTEM INTERFACE
    ${OpenImageIOLibrary_INCLUDE_DIR} ${OpenImageIOLibrary_IMATH_INCLUDE_DIR})
  target_link_libraries(OpenImageIO::Library INTERFACE
    ${OpenImageIOLibrary_LIBRARY} ${OpenImageIOLibrary_UTIL_LIBRARY})
endif()
