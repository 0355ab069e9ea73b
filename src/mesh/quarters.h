#pragma once

#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

/// Part 0 to 3 of a patch that is cut by the middles of its edges, in the order of refine().
PatchCorners quarter_of(const PatchCorners& patch, int quarter);

/// The quarter of a patch, a convex one with this normal, that contains a point of its plane; of points on a cut, or
/// slightly outside of the patch, one of those beside them.
int quarter_at(const PatchCorners& patch, const Vector& normal, const Point& point);

}  // namespace patchlight
