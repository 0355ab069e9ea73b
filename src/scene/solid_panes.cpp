#include "scene/solid_panes.h"

#include "base/rounded.h"
#include "scene/problem_face.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace patchlight {
namespace {

constexpr double thickest_pane = 0.05;    // metres
constexpr double most_of_size = 0.1;      // of the root of the area
constexpr double same_place = 0.01;       // of the same: how far corners may lie from being opposite each other
constexpr double parallel_within = 1e-4;  // cosine of the angle between normals, less than 1

// A clear face of which there may be a second one.
struct Face {
  PolygonIndex polygon = no_polygon;
  std::vector<Point> corners;
  Vector normal;
  double size = 0;  // m
};

std::vector<Face> single_faces(const Scene& scene) {
  std::vector<Face> faces;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    if (!is_opening(scene, p) || polygon.back_material.value_or(polygon.material) != polygon.material) continue;
    if ((scene.materials[polygon.material].exitance > 0).any()) continue;
    const std::vector<Point> corners = corner_points(scene, p);
    faces.push_back({p, corners, front_normal(scene, p), std::sqrt(area_vector(corners).norm())});
  }
  return faces;
}

// Lies a corner of the other face opposite each?
bool corners_are_opposite(const Face& face, const Face& other) {
  return std::all_of(face.corners.begin(), face.corners.end(), [&](const Point& corner) {
    return std::any_of(other.corners.begin(), other.corners.end(), [&](const Point& opposite) {
      const Vector way = opposite - corner;
      return (way - face.normal.dot(way) * face.normal).norm() <= same_place * face.size;
    });
  });
}

// How thick the pane is whose faces these are; 0: they are not.
double thickness_between(const Face& first, const Face& second) {
  if (first.corners.size() != second.corners.size() || !(first.normal.dot(second.normal) < parallel_within - 1))
    return 0;
  const double depth = first.normal.dot(first.corners[0] - second.corners[0]);
  if (!(depth > 0 && depth <= std::min(thickest_pane, most_of_size * first.size))) return 0;
  return corners_are_opposite(first, second) && corners_are_opposite(second, first) ? depth : 0;
}

bool has_material(const Scene& scene, const std::string& name) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [&](const Material& material) { return material.name == name; });
}

// A material that lets all light through, for the second faces of panes of another one.
Material clear_in_full(const Scene& scene, const Material& glass) {
  Material clear = glass;
  clear.reflectance.setZero();
  clear.transmittance.setOnes();
  clear.name += " (second face)";
  while (has_material(scene, clear.name)) clear.name += "'";
  return clear;
}

}  // namespace

Scene with_solid_panes_as_one(Scene scene) {
  const std::vector<Face> faces = single_faces(scene);
  std::vector<std::uint8_t> is_paired(faces.size(), 0);
  std::map<MaterialIndex, MaterialIndex> clear;
  std::size_t panes = 0;
  double thickest = 0;
  for (std::size_t a = 0; a < faces.size(); ++a) {
    const MaterialIndex glass = scene.polygons[faces[a].polygon].material;
    for (std::size_t b = a + 1; b < faces.size() && !is_paired[a]; ++b) {
      Polygon& second = scene.polygons[faces[b].polygon];
      if (is_paired[b] || second.material != glass) continue;
      const double thickness = thickness_between(faces[a], faces[b]);
      if (!(thickness > 0)) continue;
      is_paired[a] = is_paired[b] = 1;
      const auto [place, is_new] = clear.insert({glass, static_cast<MaterialIndex>(scene.materials.size())});
      if (is_new) scene.materials.push_back(clear_in_full(scene, scene.materials[glass]));
      second.material = place->second;
      second.back_material.reset();
      ++panes;
      thickest = std::max(thickest, thickness);
    }
  }
  if (panes > 0)
    scene.notes.push_back(counted(panes, "pane") + " of two parallel faces, up to " + rounded(1000 * thickest) +
                          " mm apart, " + (panes == 1 ? "counts" : "count each") + " as one thin pane");
  return scene;
}

}  // namespace patchlight
