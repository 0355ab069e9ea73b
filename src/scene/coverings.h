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

  std::span<const PolygonIndex> over_side(PolygonIndex polygon, Side side) const {
    if (over.empty()) return {};
    return over[2 * std::size_t{polygon} + static_cast<std::size_t>(side)];
  }

  /// True when `upper` lies over some place of this side of `polygon`.
  bool lies_over(PolygonIndex upper, PolygonIndex polygon, Side side) const;
};

/// Finds which polygons lie over others, among pairs within in_plane_tolerance of one plane. Geometry decides:
/// - The smaller polygon lies over the larger; of equal ones, the first one in the scene;
/// - A clear polygon lies over smaller opaque ones that cover it together, e.g. pieces of a wall on which it is drawn;
/// - A larger polygon with both sides kept lies over the outer side of a closed solid that stands against it: a desk is
///   not visible through a wall without thickness.
/// - The exception is a side of a solid that emits. It lies over the larger polygon, e.g. a lamp recessed into a
///   ceiling.
/// Only kept sides cover or are covered. Expected O(n log n) for n polygons.
Coverings find_coverings(const Scene& scene, const KeptSides& kept);

/// DiagnosticCode::overlapping_faces with the polygons that are covered in part, and DiagnosticCode::covered_lamp with
/// those of them that emit there; nothing when there are none.
Diagnostics problems_with_overlaps(const Scene& scene, const Coverings& coverings);

/// A part of the plane of some faces that none of them fills.
struct Hole {
  PolygonIndex plane = 0;                  ///< the largest of the faces in its plane
  std::vector<std::vector<Point>> pieces;  ///< convex, counter-clockwise around one normal of the plane
};

/// Finds holes between faces: parts of a face's plane that no face in that plane fills. They lie within the convex hull
/// of these faces and of corners of nearby faces in the plane. Examples are holes in walls, doorways, slits between a
/// wall and the ceiling, but also the places beside an L-shaped floor. Pieces narrower than weld_distance() are left
/// out. Cuts the largest faces first, within a limit of work; planes with very many faces have no result. Expected O(n
/// log n) for n polygons.
std::vector<Hole> holes_between_faces(const Scene& scene);

}  // namespace patchlight
