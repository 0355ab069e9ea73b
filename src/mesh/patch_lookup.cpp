#include "patchlight/mesh/patch_lookup.h"
