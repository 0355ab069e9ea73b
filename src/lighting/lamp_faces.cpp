#include "lighting/lamp_faces.h"

#include "scene/triangulate.h"

namespace patchlight {

std::vector<LampFace> lamp_faces(const Scene& scene, PolygonIndex polygon, Side side) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  const Spectrum& exitance = scene.materials[material_on(scene.polygons[polygon], side)].exitance;
  const Vector normal = (side == Side::front ? 1 : -1) * front_normal(scene, polygon);
  std::vector<LampFace> faces;
  if (corners.size() == 4 && is_convex(corners)) {
    faces.push_back(
        {{corners[0], corners[1], corners[2], corners[3]}, normal, area_vector(corners).norm(), polygon, exitance});
    return faces;
  }
  for (const auto& [a, b, c] : triangles_of(corners))
    faces.push_back({{a, b, c, c}, normal, (b - a).cross(c - a).norm() / 2, polygon, exitance});
  return faces;
}

}  // namespace patchlight
