#pragma once

#include "patchlight/scene/problem.h"
#include "patchlight/scene/scene.h"

#include <vector>

namespace patchlight {

/// That luminaires are farther from the model than it is long, and than 30 m; and that faces cut the spheres of some.
/// O(spheres x log n) for n polygons, and O(n) where there are spheres.
std::vector<Problem> problems_with_luminaires(const Scene& scene);

}  // namespace patchlight
