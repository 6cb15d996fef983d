# CGAL's header-only kernels as CGALHeaders::CGALHeaders (LGPL parts only). The package's own target
# adds -frounding-math to all who link it; here only the files that include CGAL set that flag.
find_path(CGALHeaders_INCLUDE_DIR CGAL/Exact_predicates_exact_constructions_kernel.h)
find_library(CGALHeaders_GMP gmp)
find_library(CGALHeaders_MPFR mpfr)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CGALHeaders DEFAULT_MSG
  CGALHeaders_INCLUDE_DIR CGALHeaders_GMP CGALHeaders_MPFR)
mark_as_advanced(CGALHeaders_INCLUDE_DIR CGALHeaders_GMP CGALHeaders_MPFR)
if(CGALHeaders_FOUND AND NOT TARGET CGALHeaders::CGALHeaders)
  add_library(CGALHeaders::CGALHeaders INTERFACE IMPORTED)
  target_include_directories(CGALHeaders::CGALHeaders SYSTEM INTERFACE ${CGALHeaders_INCLUDE_DIR})
  target_link_libraries(CGALHeaders::CGALHeaders INTERFACE ${CGALHeaders_MPFR} ${CGALHeaders_GMP})
endif()
