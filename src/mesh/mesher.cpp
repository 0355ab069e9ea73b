#include "patchlight/mesh/mesher.h"
