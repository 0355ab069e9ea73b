#include "patchlight/transport/dense.h"
