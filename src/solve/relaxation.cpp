#include "patchlight/solve/relaxation.h"
