#include "patchlight/form_factor/contour.h"
