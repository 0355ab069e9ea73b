#include "plan/luminaires_behind.h"

#include "patchlight/scene/triangulate.h"

#include "scene/extent.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace patchlight {
namespace {

constexpr double farthest = 1e-3;  // metres
constexpr double in_plane = 1e-9;  // of the extent: what shadow rays take for in the plane

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

}  // namespace

std::vector<std::string> notes_on_luminaires_behind(const Scene& scene) {
  std::vector<std::string> notes;
  const double nearest = in_plane * extent_of(scene);
  for (const Luminaire& luminaire : scene.luminaires) {
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      const Vector normal = front_normal(scene, p);
      const double height = normal.dot(luminaire.position - scene.vertices[scene.polygons[p].corners[0]]);
      if (std::abs(height) <= nearest || std::abs(height) > farthest) continue;
      if (height * luminaire.aim.dot(normal) >= 0 || is_opening(scene, p)) continue;
      if (!lies_over(luminaire.position, corner_points(scene, p), normal)) continue;
      std::ostringstream note;
      note.precision(3);
      note << "luminaire '" << luminaire.name << "' (" << luminaire.place << ") lies " << 1000 * std::abs(height)
           << " mm behind a face towards which it shines (" << place_of(scene, scene.polygons[p])
           << "): its light falls on the face's other side; move it through the face if that is not meant";
      notes.push_back(note.str());
      break;
    }
  }
  return notes;
}

}  // namespace patchlight
