#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <optional>

namespace patchlight {

/// Equal parallelograms, row by row, as most rectangles are cut into: the patch follows from the place.
struct PatchLattice {
  Point origin;
  Vector to_u, to_v;  ///< (x - origin) . to_u counts the patches along the first edge
  int count_u = 0, count_v = 0;

  /// The patch at a point, counted from the first one; outside of all the nearest.
  PatchIndex patch_at(const Point& point) const;
};

/// The lattice of two or more patches of one polygon side; nothing where they are none. O(patches).
std::optional<PatchLattice> lattice_of(const PatchMesh& mesh, PatchRange range);

}  // namespace patchlight
