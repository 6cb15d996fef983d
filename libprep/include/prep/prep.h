// The main job in one header: load_scene(), prepare(), save_scene().
#pragma once

#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
