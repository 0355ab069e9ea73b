#pragma once

#include "patchlight/scene/scene.h"

#include <vector>

namespace patchlight {

/// Convex parts of the planes of a scene's faces that none of the faces in that plane fills, though they lie within the
/// convex hull of those: holes in walls and what is left free for doors, but also what lies beside an L-shaped floor.
/// Counter-clockwise around one normal of the plane; parts narrower than weld_distance() are left out. Looks at the
/// largest faces first, for a tenth of a second at most; of planes with very many faces nothing is found.
/// O(n log n) for n polygons, expected.
std::vector<std::vector<Point>> holes_between_faces(const Scene& scene);

}  // namespace patchlight
