#include "patchlight/form_factor/monte_carlo.h"
