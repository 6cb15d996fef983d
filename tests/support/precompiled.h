// What most tests include, compiled once (cmake/MeshprepTargets.cmake); no test includes this file.
// Headers of packages only: a compiler cache hands the result to other clones, where #pragma once
// takes this project's own headers for other files.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>
