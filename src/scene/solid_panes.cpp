#include "scene/solid_panes.h"

#include "base/rounded.h"
#include "scene/face_tree.h"
#include "scene/model_face.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

constexpr double thickest_pane = 0.05;    // meters
constexpr double thinnest_pane = 1e-5;    // meters; nearer faces are in one plane
constexpr double most_of_size = 0.1;      // of the root of the area
constexpr double parallel_within = 1e-4;  // 1 less the cosine of the angle between planes: 0.8 degrees

// The share of a face that has to lie opposite faces of the other side: corners may be off by a hundredth of its size.
constexpr double least_opposite = 0.96;

// Pairs of faces with smaller shares in common are neighbors that overlap at an edge.
constexpr double least_common = 1 - least_opposite;

// A clear face of which there may be a second one.
struct Face {
  PolygonIndex polygon = no_polygon;
  std::vector<Triangle> triangles;
  Vector normal;
  Point middle;
  double area = 0;  // m^2
};

// Faces with a material on their back are left out: they are two faces at one place, a sheet already.
std::vector<Face> single_faces(const Scene& scene) {
  std::vector<Face> faces;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    if (!is_opening(scene, p) || polygon.back_material) continue;
    const Material& material = scene.materials[polygon.material];
    if (material.second_face || (material.exitance > 0).any()) continue;
    const std::vector<Point> corners = corner_points(scene, p);
    faces.push_back(
        {p, triangles_of(corners), front_normal(scene, p), area_centroid(corners), area_vector(corners).norm()});
  }
  return faces;
}

// How far behind the middle of a face the plane of another one is; 0 where that does not face away.
double depth_between(const Face& face, const Face& other) {
  const double cosine = face.normal.dot(other.normal);
  if (!(cosine < parallel_within - 1)) return 0;
  return std::max(0.0, other.normal.dot(face.middle - other.middle) / cosine);
}

// Two faces, by their places in a list, that lie opposite each other in part.
struct Opposite {
  std::int64_t depth = 0;  // nanometers, so that depths that differ by rounding are equal
  std::size_t first = 0, second = 0;
  double area = 0;   // m^2 in common
  double slope = 0;  // nanometers by which the depth may differ from place to place

  auto order() const { return std::tuple(depth, first, second); }
};

// All such pairs, the nearest first.
std::vector<Opposite> opposite_faces(const Scene& scene, const std::vector<Face>& faces) {
  std::vector<FlatFace> flat;
  for (const Face& face : faces) flat.push_back(flat_face(corner_points(scene, face.polygon)));
  const FaceTree tree(std::move(flat));
  constexpr double any_area = std::numeric_limits<double>::infinity();
  std::vector<Opposite> pairs;
  for (std::size_t a = 0; a < faces.size(); ++a) {
    const Face& face = faces[a];
    const Vector margin = thickest_pane * face.normal.cwiseAbs();
    const Box& box = tree.face(a).box;
    const FaceQuery query{Box(box.min() - margin, box.max() + margin),
                          any_area,
                          face.normal,
                          std::sqrt(2 * parallel_within),
                          face.normal.dot(face.middle),
                          2 * thickest_pane};
    tree.for_each(query, [&](std::size_t b) {
      const Face& other = faces[b];
      if (b <= a || scene.polygons[face.polygon].material != scene.polygons[other.polygon].material) return;
      const double depth = depth_between(face, other);
      if (!(depth >= thinnest_pane && depth <= thickest_pane)) return;
      const double area = common_area(face.triangles, other.triangles, face.normal);
      if (!(area > least_common * std::min(face.area, other.area))) return;
      const double slope = face.normal.cross(other.normal).norm() * tree.face(a).box.diagonal().norm();
      pairs.push_back({std::llround(1e9 * depth), a, b, area, 1e9 * slope});
    });
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Opposite& one, const Opposite& other) { return one.order() < other.order(); });
  return pairs;
}

// The two sides of a pane: faces by their places in a list, however each side is cut into faces.
struct SolidPane {
  std::vector<std::size_t> first, second;
  double depth = 0;  // the largest, meters
};

// Each face with the faces of the nearest plane behind it that covers it. Smaller parts that are nearer, as a handle or
// a groove, do not count.
class NearestOpposite {
 public:
  NearestOpposite(const std::vector<Face>& faces, const std::vector<Opposite>& pairs)
      : faces_(faces), partners_(faces.size()) {
    std::vector<std::vector<const Opposite*>> behind(faces.size());
    for (const Opposite& pair : pairs) {
      behind[pair.first].push_back(&pair);
      behind[pair.second].push_back(&pair);
    }
    for (std::size_t k = 0; k < faces.size(); ++k) nearest_.push_back(nearest_cover(behind[k], faces[k].area));
    for (const Opposite& pair : pairs) {
      if (!admits(nearest_[pair.first], pair) || !admits(nearest_[pair.second], pair)) continue;
      partners_[pair.first].emplace_back(pair.second, pair.area);
      partners_[pair.second].emplace_back(pair.first, pair.area);
    }
  }

  // All faces that hang together with this one; nothing when one of them lies opposite the others in part only.
  std::optional<SolidPane> pane_of(std::size_t face, std::vector<std::uint8_t>& is_visited) const {
    SolidPane pane{.first = {face}, .second = {}};
    is_visited[face] = 1;
    bool is_whole = true;
    double area = 0;
    std::vector<std::pair<std::size_t, bool>> open{{face, true}};
    while (!open.empty()) {
      const auto [k, is_first] = open.back();
      open.pop_back();
      double opposite = 0;
      for (const auto& [other, common] : partners_[k]) {
        opposite += common;
        if (is_visited[other] != 0) continue;
        is_visited[other] = 1;
        (is_first ? pane.second : pane.first).push_back(other);
        open.emplace_back(other, !is_first);
      }
      is_whole = is_whole && opposite >= least_opposite * faces_[k].area;
      pane.depth = std::max(pane.depth, 1e-9 * static_cast<double>(nearest_[k].value_or(0)));
      if (is_first) area += faces_[k].area;
    }
    if (!is_whole || pane.depth > most_of_size * std::sqrt(area)) return {};
    return pane;
  }

 private:
  // Depths in one plane differ by a tenth at most, and by their slope.
  static bool admits(const std::optional<std::int64_t>& nearest, const Opposite& pair) {
    if (!nearest || pair.depth < *nearest) return false;
    return static_cast<double>(pair.depth) <= 1.1 * static_cast<double>(*nearest) + pair.slope;
  }

  // The least depth from which on the pairs, which ascend, cover the face; nothing if they never do.
  static std::optional<std::int64_t> nearest_cover(const std::vector<const Opposite*>& behind, double area) {
    double covered = 0;
    std::size_t end = 0;
    for (std::size_t begin = 0; begin < behind.size(); ++begin) {
      for (; end < behind.size() && admits(behind[begin]->depth, *behind[end]); ++end) covered += behind[end]->area;
      if (covered >= least_opposite * area) return behind[begin]->depth;
      covered -= behind[begin]->area;
    }
    return std::nullopt;
  }

  const std::vector<Face>& faces_;
  std::vector<std::optional<std::int64_t>> nearest_;  // nanometers; nothing: no plane covers the face
  std::vector<std::vector<std::pair<std::size_t, double>>> partners_;
};

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
  clear.spectra = {};
  clear.second_face = true;
  clear.name += " (second face)";
  while (has_material(scene, clear.name)) clear.name += "'";
  return clear;
}

}  // namespace

Scene with_solid_panes_as_one(Scene scene) {
  const std::vector<Face> faces = single_faces(scene);
  if (faces.size() < 2) return scene;
  const NearestOpposite opposite(faces, opposite_faces(scene, faces));
  std::vector<std::uint8_t> is_visited(faces.size(), 0);
  std::map<MaterialIndex, MaterialIndex> clear;
  std::size_t panes = 0;
  double thickest = 0;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (is_visited[k] != 0) continue;
    const std::optional<SolidPane> pane = opposite.pane_of(k, is_visited);
    if (!pane) continue;
    const MaterialIndex material = scene.polygons[faces[k].polygon].material;
    const auto [place, is_new] = clear.insert({material, static_cast<MaterialIndex>(scene.materials.size())});
    if (is_new) scene.materials.push_back(clear_in_full(scene, scene.materials[material]));
    // The first side is seen from both sides now.
    for (const std::size_t face : pane->first) scene.polygons[faces[face].polygon].back_material = material;
    for (const std::size_t face : pane->second) scene.polygons[faces[face].polygon].material = place->second;
    ++panes;
    thickest = std::max(thickest, pane->depth);
  }
  if (panes > 0)
    scene.diagnostics.push_back({DiagnosticCode::read_as_pane,
                                 counted(panes, "pane") + " with two sides, up to " + rounded(1e3 * thickest) +
                                     " mm apart, " + (panes == 1 ? "counts" : "count each") + " as one thin pane",
                                 panes});
  return scene;
}

}  // namespace patchlight
