#include "patchlight/mesh/interpolate.h"
