#include "plan/luminaires_behind.h"

#include "scene/extent.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <variant>

namespace patchlight {
namespace {

constexpr double farthest = 1.001e-3;  // metres: a millimetre, rounded
constexpr double in_plane = 1e-9;      // of the extent: what shadow rays take for in the plane

// Does the point lie over the polygon, seen along its normal?
bool lies_over(const Point& point, const std::vector<Point>& corners, const Vector& normal) {
  const auto triangles = triangulate(corners);
  const auto is_left = [&](std::size_t a, std::size_t b) {
    return normal.dot((corners[b] - corners[a]).cross(point - corners[a])) >= 0;
  };
  return std::any_of(triangles.begin(), triangles.end(), [&](const auto& triangle) {
    const auto& [a, b, c] = triangle;
    return is_left(a, b) && is_left(b, c) && is_left(c, a);
  });
}

// What is to be said of a luminaire at this height over the front of a face over which it lies; nothing where it is
// well before the side that it lights.
std::string trouble_at(const Luminaire& luminaire, double height, const Vector& normal, double nearest) {
  std::ostringstream text;
  text.precision(3);
  if (std::abs(height) <= nearest) {
    if (std::holds_alternative<PointLight>(luminaire.light))
      text << "in the plane of a face, so that half of its light goes to either side";
  } else if (height * luminaire.aim.dot(normal) < 0) {
    text << 1000 * std::abs(height) << " mm behind a face towards which it shines, so that it lights the other side";
  }
  return text.str();
}

}  // namespace

std::vector<std::string> notes_on_luminaires_behind(const Scene& scene) {
  std::vector<std::string> notes;
  const double nearest = in_plane * extent_of(scene);
  for (const Luminaire& luminaire : scene.luminaires) {
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      const Vector normal = front_normal(scene, p);
      const double height = normal.dot(luminaire.position - scene.vertices[scene.polygons[p].corners[0]]);
      if (std::abs(height) > farthest || is_opening(scene, p)) continue;
      const std::string trouble = trouble_at(luminaire, height, normal, nearest);
      if (trouble.empty() || !lies_over(luminaire.position, corner_points(scene, p), normal)) continue;
      notes.push_back("luminaire '" + luminaire.name + "' (" + luminaire.place + ") lies " + trouble + " (" +
                      place_of(scene, scene.polygons[p]) + "); move it if that is not meant");
      break;
    }
  }
  return notes;
}

}  // namespace patchlight
