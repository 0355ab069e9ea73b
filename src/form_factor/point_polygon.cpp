#include "patchlight/form_factor/point_polygon.h"
