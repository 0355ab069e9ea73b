#include "patchlight/gather/gather.h"
