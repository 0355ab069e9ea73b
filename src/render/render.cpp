#include "patchlight/render/render.h"
