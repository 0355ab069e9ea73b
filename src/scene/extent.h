#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// How near two vertices of a model with these bounds are to be one, in meters: tolerance_of_coordinates of the longest
/// side, or more where double precision does not resolve that, far away from the origin. Exporters write six
/// significant digits or single precision, so one vertex written twice differs by at most 1e-6 of the largest
/// coordinate. Smaller details are lost; shadow rays, traced in single precision, would hardly see them.
double weld_distance(const Box& bounds);

/// The vertices that polygons use, ascending.
std::vector<std::uint32_t> used_vertices(const Scene& scene);

/// For every point the index of the first point that is not farther than `distance` among those that stand for
/// themselves; often its own. O(n).
std::vector<std::uint32_t> welded(std::span<const Point> points, double distance);

/// Bounds of the main part of the model: a stray vertex a hundred kilometers away shall not decide how large details
/// are. The middle is the median of the corners, weighted by the area of their polygons, of which none counts for more
/// than an eighth of all. Corners farther from it than 100 times the distance within which three fifths of that area
/// lie are left out, unless the whole is 1e12 times as large as the rest. Most models have none: then these are the
/// bounds of all vertices that polygons use. O(n) for n corners, expected.
Box main_bounds(const Scene& scene);

/// The diagonal of main_bounds() in meters, to which tolerances are relative.
double extent_of(const Scene& scene);

/// The distance within which vertices are merged, in meters: weld_distance() of the main bounds, reduced by factors of
/// ten if needed. Then faces narrower than it are at most a millionth of the area, or a fifth of all faces. Slivers, a
/// hundred thousand times as long as wide, do not count. Large polygons count like in main_bounds().
double weld_distance(const Scene& scene);

/// The polygons with a corner outside of main_bounds(), in order.
std::vector<PolygonIndex> far_polygons(const Scene& scene);

/// Per polygon 1 where its corners, or those of a polygon that it shares one with, are off one plane by more than
/// weld_distance(), so that contacts with it are unknown. Coordinates far from the origin in single precision are.
std::vector<std::uint8_t> bent_faces(const Scene& scene);

/// Rays are traced in single precision in a scene of unit extent. Beyond this many extents, a ray is indistinguishable
/// from a parallel one; beyond 1e18, there is none.
inline constexpr double most_extents = 1e12;

/// How far a position may be from the middle of a scene: most_extents of its main_bounds().
struct Reach {
  Point centre;
  double distance = 0;  ///< m
};

/// How far a scene reaches, which must have faces.
Reach reach_of(const Scene& scene);

/// \throws InputError at `where` when a position in meters is out of reach; the message calls it `what`.
void require_in_reach(const Reach& reach, const Point& position, const std::string& where, const std::string& what);

/// Checks every position and every strength of light of a scene besides its vertices. Light up to 1e25 (W/m^2, W/sr or
/// W) leaves results that single precision can write; the sun's surface has 6e7. The squares of light from 1e-150 on
/// are normal numbers. \throws InputError naming the value that is out of range.
void check_limits(const Scene& scene);

}  // namespace patchlight
