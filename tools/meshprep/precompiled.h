// What most sources include, compiled once (cmake/MeshprepTargets.cmake); no source includes this
// file.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "../../libprep/src/base/precompiled.h"
