#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "scene/shells.h"
#include "scene/triangulate.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A closed set of polygons with a volume, consistently oriented once those that are turned are turned back.
struct Solid {
  std::vector<PolygonIndex> polygons;
  bool fronts_face_inside = false;  ///< those of the polygons that are not turned
  bool has_opening = false;         ///< a clear face or a sheet: light gets in and out
  Box box;
  std::vector<Triangle> triangles;  ///< oriented as the polygons
};

/// The solid of these polygons of one shell and of lids over its rims, which are oriented as the polygons once those
/// turned are turned back; nothing when it has no volume.
std::optional<Solid> solid_of(const Scene& scene, std::vector<PolygonIndex> polygons, const Shells& shells,
                              std::vector<Triangle> lids = {});

/// The side of one of its polygons that faces its inside.
Side inner_side(const Solid& solid, const Shells& shells, PolygonIndex polygon);

/// True when the solid has winding number +-1 around the point. O(triangles).
bool holds(const Solid& solid, const Point& point);

/// A step from a side into the space before it, by 1e-6 of the scene's `extent`.
Vector step_before(const Scene& scene, PolygonIndex polygon, Side side, double extent);

/// A point one step_before() the middle of a side. The middle is that of the polygon's
/// largest triangle, inside the polygon even when that is not convex.
Point point_before(const Scene& scene, PolygonIndex polygon, Side side, double extent);

/// Its corners in that space, a little nearer to the middle, as corners may touch a wall.
std::vector<Point> corners_before(const Scene& scene, PolygonIndex polygon, Side side, double extent);

/// At 2 * polygon + side 1 when the side belongs to one of these solids and faces its inside.
std::vector<std::uint8_t> inner_sides(const Scene& scene, const Shells& shells, std::span<const Solid> solids);

/// The shells of a scene and the solids of those that are closed. Computed once for a scene that is ready, by
/// kept_sides() or sides_for(); all later steps take them from KeptSides.
struct SceneGeometry {
  Shells shells;
  std::vector<Solid> solids;
  std::vector<std::uint8_t> inner;  ///< inner_sides() of these solids
};

/// O(n log n) for n corners.
SceneGeometry compute_geometry(const Scene& scene);

/// That of the kept sides, or a new one for sides that were not chosen by kept_sides().
std::shared_ptr<const SceneGeometry> geometry_of(const Scene& scene, const KeptSides& kept);

/// At 2 * polygon + side 1 when the side faces the inside of one of these solids: it belongs to the solid, or
/// point_before() and the like of all its corners lie within. Looks for at most 2e7 tests of a box or triangle, a
/// fraction of a second, in the largest solids first; the rest is 0.
std::vector<std::uint8_t> sides_within(const Scene& scene, const Shells& shells, std::span<const Solid> solids);

/// A source of light as solids see it: the triangles of an emitting side, moved just before it, or a ball around a
/// luminaire, which has no triangles.
struct LampShape {
  std::vector<Triangle> triangles;
  Point middle = Point::Zero();  ///< a point of it
  double radius = 0;             ///< of a ball, meters; 0 for one without extent
  Box box;
};

/// The shapes of every side that emits and of every luminaire.
std::vector<LampShape> lamp_shapes(const Scene& scene, double extent);

/// The distance of a point to the nearest triangle of a solid, m.
double distance_to(const Solid& solid, const Point& point);

/// The distance of a point to a triangle, m.
double distance_to(const Triangle& triangle, const Point& point);

/// Where a lamp lies with respect to a closed solid: both when it crosses the surface, or comes so near to it that
/// rounding decides.
struct LampPlaces {
  bool inside = false;
  bool outside = false;
};

/// The places of all lamps together. Lamps within 5e-7 of the scene's `extent` of the surface count as inside and
/// outside, so that no light is lost. O(lamps x triangles of the solid).
LampPlaces places_of(const std::vector<LampShape>& lamps, const Solid& solid, double extent);

/// The dark solids of kept_sides(): bodies that no light gets into. None in a scene without light.
std::vector<Solid> dark_solids(const Scene& scene);

}  // namespace patchlight
