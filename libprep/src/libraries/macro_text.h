// What a macro stands for, as text.
#pragma once

#define MESHPREP_TEXT_OF(x) #x
#define MESHPREP_TEXT(x) MESHPREP_TEXT_OF(x)
