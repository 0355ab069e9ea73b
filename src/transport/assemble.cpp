#include "patchlight/transport/assemble.h"
