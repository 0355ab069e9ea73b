#pragma once

#include "patchlight/scene/scene.h"

#include <optional>
#include <vector>

namespace patchlight {

/// What becomes of one polygon.
struct Pieces {
  std::vector<Polygon> polygons;         ///< simple and planar, with area
  std::vector<Point> new_vertices;       ///< numbered after those of the scene
  std::optional<DiagnosticCode> defect;  ///< zero_area, self_intersecting or non_planar; nothing when it stays whole
};

/// Cuts a polygon of the scene into what the mesher can use. Pieces narrower than `width` are left out.
Pieces pieces_of(const Scene& scene, const Polygon& polygon, double width);

}  // namespace patchlight
