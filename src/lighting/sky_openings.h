#pragma once

#include "patchlight/scene/scene.h"

#include "lighting/light_paths.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace patchlight {

/// Something through which the sky may be seen, and towards which rays are sent to find it: a clear face, or a hole.
struct Opening {
  PolygonIndex polygon = no_polygon;  ///< none: a hole
  Vector normal;                      ///< unit
  Point centre;
  double radius = 0;                            ///< meters: no corner is farther from the center
  double area = 0;                              ///< m^2
  std::vector<std::array<Point, 3>> triangles;  ///< that it consists of, in one plane
  std::vector<double> upto = {};                ///< per triangle: the area of it and all before, m^2
};

/// That of a polygon as a whole.
Opening opening_at(const Scene& scene, PolygonIndex polygon);

/// Places that see more than this share of the sky find it without aiming at openings.
inline constexpr double much_sky = 0.25;

/// All clear faces, in the order of their polygons. Then up to 256 of holes_between_faces(): those that let in most
/// straight lines from the sky to places that see less than `much_sky` of it. A hole whose light passes another opening
/// is left out, e.g. a gap between furniture behind a window. If there are too many holes, those of one plane are
/// merged first. Rays find the holes; a missed hole costs accuracy only.
std::vector<Opening> sky_openings(const Scene& scene, const LightPaths& paths);

/// The place of the first hole among sky_openings().
std::size_t first_hole(const std::vector<Opening>& openings);

/// The place of a clear face among them; nothing for other polygons.
std::optional<std::size_t> opening_of(const std::vector<Opening>& openings, PolygonIndex polygon);

/// Uniformly distributed over an opening for (u, v) of the unit square.
Point point_of(const Opening& opening, double u, double v);

/// How far along a ray in a unit direction an opening lies; nothing when it is not met.
std::optional<double> distance_to(const Opening& opening, const Point& origin, const Vector& direction);

/// The density, 1/sr, in a unit direction of rays that choose an opening with this probability and then a point of it,
/// where they meet it at this distance.
double density_at(const Opening& opening, double probability, double distance, const Vector& direction);

/// Approximately the solid angle that it would fill if it were turned to a place.
double apparent_size(const Opening& opening, const Point& from);

/// True when a corner of the opening is so high above the plane through a point.
bool rises_above(const Opening& opening, const Point& on_plane, const Vector& normal, double height);

}  // namespace patchlight
