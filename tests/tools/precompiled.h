// What most tests of the command include besides, compiled once; no test includes this file.
#pragma once

#include <nlohmann/json.hpp>

#include "../support/precompiled.h"
