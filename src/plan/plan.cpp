#include "patchlight/plan/plan.h"
