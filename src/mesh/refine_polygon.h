#pragma once

#include "mesh/outline.h"

namespace patchlight {

/// A Delaunay mesh of triangles of any simple polygon: its triangulation with the boundary cut at the prescribed
/// points, then split at the longest inner edge until none is longer than `max_edge`.
PolygonMesh refine_polygon(const Outline& outline, double max_edge);

}  // namespace patchlight
