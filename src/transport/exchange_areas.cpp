#include "patchlight/transport/exchange_areas.h"
