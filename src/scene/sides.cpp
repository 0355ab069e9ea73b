#include "patchlight/scene/sides.h"
