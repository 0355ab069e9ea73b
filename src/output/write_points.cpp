#include "patchlight/output/write_points.h"
