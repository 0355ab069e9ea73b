#include "patchlight/solve/solve.h"
