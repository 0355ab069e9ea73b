#include "patchlight/output/whole_file.h"
