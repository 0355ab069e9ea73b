#include "patchlight/visibility/occluder.h"
