#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Stands for "no patch".
inline constexpr PatchIndex no_patch = ~PatchIndex{0};

/// Where arrays of both sides of all polygons have this side.
inline std::size_t side_slot(PolygonIndex polygon, Side side) {
  return 2 * std::size_t{polygon} + static_cast<std::size_t>(side);
}

/// The corners of one patch: three or four points.
struct PatchCorners {
  std::array<Point, 4> points;
  int count = 0;
  operator std::span<const Point>() const { return {points.data(), static_cast<std::size_t>(count)}; }
};

/// A vertex in the middle between two others, where a patch was cut.
struct Middle {
  std::uint32_t vertex;
  std::array<std::uint32_t, 2> ends;
};

/// The patches of a scene: triangles and planar convex quadrilaterals, each on one side of one polygon. simulate()
/// makes it, and nothing changes it. Every per-patch array has size() entries.
struct PatchMesh {
  std::vector<Point> vertices;                        ///< meters
  std::vector<std::array<std::uint32_t, 4>> corners;  ///< counter-clockwise from the front; a triangle repeats its last
  std::vector<Point> centroid;
  std::vector<Vector> normal;  ///< unit, out of the patch's front
  std::vector<double> area;    ///< m^2, positive
  std::vector<MaterialIndex> material;
  std::vector<PolygonIndex> polygon;    ///< the scene's polygon that the patch lies on
  std::vector<Side> side;               ///< the side of that polygon which is the patch's front
  std::vector<PatchIndex> first_patch;  ///< per side_slot() a side: its first patch; one more entry at the end

  std::vector<PolygonIndex> sheets;  ///< the translucent polygons with both sides, whose patches lie back to back

  std::vector<Middle> middles;  ///< of all edges that were cut. Where a neighbor was not, it still has the whole
                                ///< edge, and the vertex hangs on it

  PatchIndex size() const { return static_cast<PatchIndex>(area.size()); }
  PatchCorners corner_points(PatchIndex patch) const;
  /// The patches of one side of a polygon; empty when that side is not kept.
  PatchRange patches_on(PolygonIndex on_polygon, Side on_side) const;
};

}  // namespace patchlight
