#pragma once

#include "patchlight/scene/scene.h"

#include "lighting/light_paths.h"

#include <array>
#include <optional>
#include <vector>

namespace patchlight {

/// Something through which the sky may be seen, and towards which rays are sent to find it: a clear face, or a hole.
struct Opening {
  PolygonIndex polygon = no_polygon;  ///< none: a hole
  Vector normal;                      ///< unit
  Point centre;
  double radius = 0;                            ///< metres: no corner is farther from the centre
  double area = 0;                              ///< m^2
  std::vector<std::array<Point, 3>> triangles;  ///< that it consists of, in one plane
  std::vector<double> upto = {};                ///< per triangle: the area of it and all before, m^2
};

/// That of a polygon as a whole.
Opening opening_at(const Scene& scene, PolygonIndex polygon);

/// Places that see more than this share of the sky find it without aiming at openings.
inline constexpr double much_sky = 0.25;

/// All clear faces, and of holes_between_faces() those through which the sky shines at places that see less of it
/// than that, at most 256: those through which most straight lines get in.
/// Where there are more, all of one plane are one opening first. Found by rays; that a hole is missed costs
/// accuracy alone.
std::vector<Opening> sky_openings(const Scene& scene, const LightPaths& paths);

/// All clear faces of these, and the holes through which light gets in that passes no opening kept before: gaps between
/// furniture behind a window, and the other holes of its frame, say nothing more of the sky.
std::vector<Opening> openings_apart(const std::vector<Opening>& openings, const LightPaths& paths);

/// Uniformly distributed over an opening for (u, v) of the unit square.
Point point_of(const Opening& opening, double u, double v);

/// How far along a ray in a unit direction an opening lies; nothing when it is not met.
std::optional<double> distance_to(const Opening& opening, const Point& origin, const Vector& direction);

}  // namespace patchlight
