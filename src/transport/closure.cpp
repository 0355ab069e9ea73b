#include "patchlight/transport/closure.h"
