#include "scene/solid_panes.h"

#include "base/rounded.h"
#include "scene/face_tree.h"
#include "scene/model_face.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>
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

// Those with one front: a face with a material on its back is two faces in one place, a sheet already.
std::vector<Face> single_faces(const Scene& scene) {
  std::vector<Face> faces;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    if (!is_opening(scene, p) || polygon.back_material) continue;
    if ((scene.materials[polygon.material].exitance > 0).any()) continue;
    const std::vector<Point> corners = corner_points(scene, p);
    faces.push_back({p, corners, front_normal(scene, p), std::sqrt(area_vector(corners).norm())});
  }
  return faces;
}

// How thick the pane is whose faces these are, in the mean of its corners; 0: they are not, or a corner of one has none
// of the other opposite.
double thickness_between(const Face& first, const Face& second) {
  if (first.corners.size() != second.corners.size() || !(first.normal.dot(second.normal) < parallel_within - 1))
    return 0;
  const double thickest = std::min(thickest_pane, most_of_size * first.size);
  double sum = 0;
  for (const Point& corner : first.corners) {
    const auto is_opposite = [&](const Point& other) {
      const Vector way = corner - other;
      const double depth = first.normal.dot(way);
      return depth > 0 && depth <= thickest && (way - depth * first.normal).norm() <= same_place * first.size;
    };
    const auto opposite = std::find_if(second.corners.begin(), second.corners.end(), is_opposite);
    if (opposite == second.corners.end()) return 0;
    sum += first.normal.dot(corner - *opposite);
  }
  return sum / static_cast<double>(first.corners.size());
}

// Two faces by their places in a list.
struct SolidPane {
  std::int64_t thickness = 0;  // nanometres, so that what differs by rounding is equal
  std::size_t first = 0, second = 0;

  auto order() const { return std::tuple(thickness, first, second); }
};

// All pairs that could be one, the thinnest first.
std::vector<SolidPane> possible_panes(const Scene& scene, const std::vector<Face>& faces) {
  std::vector<FlatFace> flat;
  for (const Face& face : faces) flat.push_back(flat_face(face.corners));
  const FaceTree tree(std::move(flat));
  constexpr double any_area = std::numeric_limits<double>::infinity();
  std::vector<SolidPane> panes;
  for (std::size_t a = 0; a < faces.size(); ++a) {
    const Vector margin = Vector::Constant(thickest_pane);
    const Box& box = tree.face(a).box;
    const Vector& normal = faces[a].normal;
    const FaceQuery query{Box(box.min() - margin, box.max() + margin),
                          any_area,
                          normal,
                          std::sqrt(2 * parallel_within),
                          normal.dot(faces[a].corners[0]),
                          2 * thickest_pane};
    tree.for_each(query, [&](std::size_t b) {
      if (b <= a || scene.polygons[faces[a].polygon].material != scene.polygons[faces[b].polygon].material) return;
      const double thickness = thickness_between(faces[a], faces[b]);
      if (thickness > 0) panes.push_back({std::llround(1e9 * thickness), a, b});
    });
  }
  std::sort(panes.begin(), panes.end(),
            [](const SolidPane& one, const SolidPane& other) { return one.order() < other.order(); });
  return panes;
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
  clear.stated_pane.reset();
  clear.second_face = true;
  clear.name += " (second face)";
  while (has_material(scene, clear.name)) clear.name += "'";
  return clear;
}

}  // namespace

Scene with_solid_panes_as_one(Scene scene) {
  const std::vector<Face> faces = single_faces(scene);
  if (faces.size() < 2) return scene;
  std::vector<std::uint8_t> is_paired(faces.size(), 0);
  std::map<MaterialIndex, MaterialIndex> clear;
  std::size_t panes = 0;
  std::int64_t thickest = 0;
  for (const SolidPane& pane : possible_panes(scene, faces)) {
    if (is_paired[pane.first] != 0 || is_paired[pane.second] != 0) continue;
    is_paired[pane.first] = is_paired[pane.second] = 1;
    Polygon& first = scene.polygons[faces[pane.first].polygon];
    const auto [place, is_new] = clear.insert({first.material, static_cast<MaterialIndex>(scene.materials.size())});
    if (is_new) scene.materials.push_back(clear_in_full(scene, scene.materials[first.material]));
    // The first is seen from both sides now.
    first.back_material = first.material;
    scene.polygons[faces[pane.second].polygon].material = place->second;
    ++panes;
    thickest = std::max(thickest, pane.thickness);
  }
  if (panes > 0)
    scene.diagnostics.push_back(
        {DiagnosticCode::read_as_pane, counted(panes, "pane") + " of two parallel faces, up to " +
                                           rounded(1e-6 * static_cast<double>(thickest)) + " mm apart, " +
                                           (panes == 1 ? "counts" : "count each") + " as one thin pane"});
  return scene;
}

}  // namespace patchlight
