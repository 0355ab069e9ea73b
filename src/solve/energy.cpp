#include "patchlight/solve/energy.h"
