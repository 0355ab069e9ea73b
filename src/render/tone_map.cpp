#include "patchlight/render/tone_map.h"
