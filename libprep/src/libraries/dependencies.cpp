#include <CGAL/version.h>
#include <Imath/ImathConfig.h>
#include <OpenImageIO/oiioversion.h>
#include <OpenMesh/Core/System/config.h>
#include <draco/core/draco_version.h>
#include <gmp.h>
#include <hwy/highway.h>
#include <jconfig.h>
#include <meshoptimizer.h>
#include <mpfr.h>
#include <oneapi/tbb/version.h>
#include <opensubdiv/version.h>
#include <png.h>
#include <zlib.h>

#include <boost/version.hpp>
#include <glm/detail/setup.hpp>
#include <nlohmann/detail/abi_macros.hpp>

#include "libraries/macro_text.h"
#include "prep/version.h"

namespace prep {
namespace {

std::string dotted(unsigned major, unsigned minor, unsigned patch) {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace

std::vector<Dependency> dependencies() {
    return {
        {"Assimp", MESHPREP_ASSIMP_VERSION, "BSD-3-Clause"},  // its headers do not say it
        {"Boost", dotted(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100),
         "BSL-1.0"},
        {"CGAL", MESHPREP_TEXT(CGAL_VERSION), "LGPL-3.0-or-later (kernels only)"},
        {"Draco", draco::kDracoVersion, "Apache-2.0"},
        {"fast_float", "", "MIT or Apache-2.0"},
        {"GLM", dotted(GLM_VERSION_MINOR, GLM_VERSION_PATCH, GLM_VERSION_REVISION), "MIT"},
        {"GMP", dotted(__GNU_MP_VERSION, __GNU_MP_VERSION_MINOR, __GNU_MP_VERSION_PATCHLEVEL),
         "LGPL-3.0-or-later or GPL-2.0-or-later"},
        {"Highway", dotted(HWY_MAJOR, HWY_MINOR, HWY_PATCH), "Apache-2.0"},
        {"Imath", IMATH_VERSION_STRING, "BSD-3-Clause"},
        {"meshoptimizer",
         std::to_string(MESHOPTIMIZER_VERSION / 1000) + "." +
             std::to_string(MESHOPTIMIZER_VERSION / 10 % 100),
         "MIT"},
        {"libjpeg-turbo", MESHPREP_TEXT(LIBJPEG_TURBO_VERSION), "IJG, BSD-3-Clause and Zlib"},
        {"libpng", PNG_LIBPNG_VER_STRING, "libpng-2.0"},
        {"MPFR", MPFR_VERSION_STRING, "LGPL-3.0-or-later"},
        {"nlohmann/json",
         dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                NLOHMANN_JSON_VERSION_PATCH),
         "MIT"},
        {"oneTBB", dotted(TBB_VERSION_MAJOR, TBB_VERSION_MINOR, TBB_VERSION_PATCH), "Apache-2.0"},
        {"OpenImageIO", dotted(OIIO_VERSION_MAJOR, OIIO_VERSION_MINOR, OIIO_VERSION_PATCH),
         "BSD-3-Clause"},
        {"OpenSubdiv",
         dotted(OPENSUBDIV_VERSION_MAJOR, OPENSUBDIV_VERSION_MINOR, OPENSUBDIV_VERSION_PATCH),
         "Apache-2.0, modified"},
        {"OpenMesh", dotted(OM_GET_VER, OM_GET_MAJ, OM_GET_MIN), "BSD-3-Clause"},
        {"zlib", ZLIB_VERSION, "Zlib"},
    };
}

}  // namespace prep
