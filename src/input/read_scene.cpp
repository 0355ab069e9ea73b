#include "patchlight/input/read_scene.h"
