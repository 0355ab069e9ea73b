#include "patchlight/solve/southwell.h"
