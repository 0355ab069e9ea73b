#include "patchlight/simulate.h"
