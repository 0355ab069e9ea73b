#include "patchlight/output/write_image.h"
