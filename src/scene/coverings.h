#pragma once

#include "patchlight/base/diagnostics.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <span>
#include <vector>

namespace patchlight {

/// A point nearer to a plane than this share of the scene's extent counts as in it in single precision, by rounding.
constexpr double in_plane_tolerance = 3e-7;

/// Where polygons lie one on the other in the same plane, as a rug drawn on a floor, or the floors of two solids: for
/// each side of a polygon the polygons that lie over part of it and face the same way.
struct Coverings {
  std::vector<std::vector<PolygonIndex>> over;  ///< at 2 * polygon + side, ascending; empty when nothing overlaps

  std::span<const PolygonIndex> over_side(PolygonIndex polygon, Side side) const;

  /// True when `upper` lies over some place of this side of `polygon`.
  bool lies_over(PolygonIndex upper, PolygonIndex polygon, Side side) const;
};

/// Of two polygons within in_plane_tolerance of one plane the smaller lies over the larger, of equal ones the first in
/// the scene over the later one. A clear one lies over smaller opaque ones that cover it together, the pieces of a wall
/// on which it is drawn. A larger one with both sides kept lies over the outer side of a closed solid, which stands
/// against it: from beyond a wall without thickness no desk is seen. So geometry alone decides, with one exception: the
/// side of a solid that emits lies over the larger one, as that of a lamp which is let into a ceiling. Only kept sides
/// cover or are covered. Expected O(n log n) for n polygons.
Coverings find_coverings(const Scene& scene, const KeptSides& kept);

/// DiagnosticCode::overlapping_faces with the polygons that are covered in part, and DiagnosticCode::covered_lamp with
/// those of them that emit there; nothing when there are none.
Diagnostics problems_with_overlaps(const Scene& scene, const Coverings& coverings);

/// A part of the plane of some faces that none of them fills.
struct Hole {
  PolygonIndex plane = 0;                  ///< the largest of the faces in its plane
  std::vector<std::vector<Point>> pieces;  ///< convex, counter-clockwise around one normal of the plane
};

/// Parts of the planes of a scene's faces that none of the faces in that plane fills, though they lie within the convex
/// hull of these and of corners of other faces near by that lie in the plane: holes in walls, doorways, slits between a
/// wall and the ceiling above it; but also the places beside an L-shaped floor. Pieces narrower than weld_distance()
/// are left out. Cuts the largest faces first, for some tenths of a second at most; of planes with very many faces
/// nothing is found. O(n log n) for n polygons, expected.
std::vector<Hole> holes_between_faces(const Scene& scene);

}  // namespace patchlight
