#pragma once

#include "patchlight/plan/plan.h"

namespace patchlight {

/// \throws InputError when parts of the request cannot be together, or the scene does not have what it names.
void check(const Request& request, const Scene& scene);

}  // namespace patchlight
