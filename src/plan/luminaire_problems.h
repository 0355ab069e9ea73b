#pragma once

#include "patchlight/scene/problem.h"
#include "patchlight/scene/scene.h"

#include <vector>

namespace patchlight {

/// That luminaires are farther from the model than it is long, and than 30 m; and that faces cut the spheres of some.
/// O(n log n) for n polygons where there are spheres, else O(n).
std::vector<Problem> problems_with_luminaires(const Scene& scene);

}  // namespace patchlight
