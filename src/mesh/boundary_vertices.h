#pragma once

#include "mesh/outline.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// The mesh's vertices on the boundaries of polygons.
struct BoundaryVertices {
  std::vector<Point> points;
  std::vector<std::vector<std::uint32_t>> of_polygon;  ///< index into points, per polygon and boundary point
};

/// Numbers the boundary points of this side of the kept polygons (kept[p] != 0). Two polygons share the points of a
/// common edge when they have one material, traverse the edge in opposite directions, are the only two of that material
/// there, their normals differ by less than 30 degrees, and no third polygon that has the same edge, from end to
/// end, rises from it on this side of them; the corners of such polygons are shared too. All other points are separate.
/// Positions are compared bit by bit.
BoundaryVertices number_boundary(const Scene& scene, std::span<const Outline> outlines, Side side,
                                 std::span<const std::uint8_t> kept);

}  // namespace patchlight
