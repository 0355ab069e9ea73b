#include "scene/openings.h"

#include "base/words.h"
#include "scene/coverings.h"
#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/model_face.h"
#include "scene/simple_polygon.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

using Loop = std::vector<std::uint32_t>;

double distance(const Point& point, const Point& from, const Point& to) {
  const Vector edge = to - from;
  const double along = std::clamp(edge.dot(point - from) / edge.squaredNorm(), 0.0, 1.0);
  return (point - from - along * edge).norm();
}

// True when two segments of one plane cross or come nearer than `near`.
bool meet(const std::pair<Point, Point>& a, const std::pair<Point, Point>& b, const Vector& normal, double near) {
  const bool cross = turn(normal, a.first, a.second, b.first) * turn(normal, a.first, a.second, b.second) < 0 &&
                     turn(normal, b.first, b.second, a.first) * turn(normal, b.first, b.second, a.second) < 0;
  return cross || distance(a.first, b.first, b.second) <= near || distance(a.second, b.first, b.second) <= near ||
         distance(b.first, a.first, a.second) <= near || distance(b.second, a.first, a.second) <= near;
}

std::pair<Point, Point> edge_of(const Scene& scene, const Loop& loop, std::size_t k) {
  return {scene.vertices[loop[k]], scene.vertices[loop[(k + 1) % loop.size()]]};
}

bool outlines_meet(const Scene& scene, const Loop& a, const Loop& b, const Vector& normal, double near) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t n = 0; n < b.size(); ++n) {
      if (meet(edge_of(scene, a, k), edge_of(scene, b, n), normal, near)) return true;
    }
  }
  return false;
}

bool encloses(const std::vector<Point>& outline, const Point& point) {
  const std::vector<Triangle> triangles = triangles_of(outline);
  const Vector normal = area_vector(outline);
  return std::any_of(triangles.begin(), triangles.end(),
                     [&](const Triangle& t) { return contains(normal, t[0], t[1], t[2], point); });
}

// Is a segment between corners of two loops free of the edges of a loop, but for those at its own ends?
bool is_free(const Scene& scene, std::uint32_t from, std::uint32_t to, const Loop& loop, const Vector& normal) {
  const std::pair<Point, Point> segment{scene.vertices[from], scene.vertices[to]};
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const std::uint32_t a = loop[k];
    const std::uint32_t b = loop[(k + 1) % loop.size()];
    if (a == from || a == to || b == from || b == to) continue;
    if (meet(segment, edge_of(scene, loop, k), normal, 0)) return false;
  }
  return true;
}

// The outline joined to a hole by the shortest seam that crosses no edge; `holes` are all that are to be joined.
std::optional<Loop> joined(const Scene& scene, const Loop& outline, std::span<const Loop> holes, const Vector& normal) {
  const Loop& hole = holes.front();
  double shortest = std::numeric_limits<double>::infinity();
  std::pair<std::size_t, std::size_t> ends;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const double length = (scene.vertices[outline[i]] - scene.vertices[hole[j]]).norm();
      if (length >= shortest || !is_free(scene, outline[i], hole[j], outline, normal)) continue;
      if (!std::all_of(holes.begin(), holes.end(),
                       [&](const Loop& other) { return is_free(scene, outline[i], hole[j], other, normal); }))
        continue;
      shortest = length;
      ends = {i, j};
    }
  }
  if (!std::isfinite(shortest)) return std::nullopt;
  Loop result;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    result.push_back(outline[i]);
    if (i != ends.first) continue;
    for (std::size_t j = 0; j <= hole.size(); ++j) result.push_back(hole[(ends.second + j) % hole.size()]);
    result.push_back(outline[i]);
  }
  return result;
}

// The wall with holes that run against its outline; nothing where one of them does not lie within it, apart from
// others.
std::optional<Loop> with_holes(const Scene& scene, const Loop& wall, const std::vector<Loop>& panes, double near) {
  const std::vector<Point> outline = corner_points(scene, wall);
  const Vector normal = area_vector(outline).normalized();
  std::vector<Loop> holes;
  for (Loop hole : panes) {
    if (area_vector(corner_points(scene, hole)).dot(normal) > 0) std::reverse(hole.begin(), hole.end());
    if (outlines_meet(scene, wall, hole, normal, near)) return std::nullopt;
    if (!encloses(outline, scene.vertices[hole.front()])) return std::nullopt;
    for (const Loop& other : holes) {
      if (outlines_meet(scene, other, hole, normal, near)) return std::nullopt;
    }
    holes.push_back(std::move(hole));
  }
  Loop cut = wall;
  for (std::size_t k = 0; k < holes.size(); ++k) {
    std::optional<Loop> next = joined(scene, cut, std::span(holes).subspan(k), normal);
    if (!next) return std::nullopt;
    cut = std::move(*next);
  }
  return cut;
}

std::vector<std::vector<Point>> in_pieces(const Scene& scene, const Loop& wall, const std::vector<Loop>& panes,
                                          double width) {
  std::vector<std::vector<Point>> pieces;
  for (const Triangle& t : triangles_of(corner_points(scene, wall))) pieces.emplace_back(t.begin(), t.end());
  for (const Loop& pane : panes) {
    for (const Triangle& t : triangles_of(corner_points(scene, pane))) pieces = beside(pieces, t, width);
  }
  return pieces;
}

// The outlines of the clear faces that lie over an opaque one.
std::vector<Loop> panes_over(const Scene& scene, const Coverings& coverings, PolygonIndex wall) {
  std::vector<PolygonIndex> over;
  if (is_opening(scene, wall)) return {};
  for (const Side side : {Side::front, Side::back}) {
    for (const PolygonIndex other : coverings.over_side(wall, side)) {
      if (is_opening(scene, other) && std::find(over.begin(), over.end(), other) == over.end()) over.push_back(other);
    }
  }
  std::vector<Loop> panes;
  for (const PolygonIndex pane : over) panes.push_back(scene.polygons[pane].corners);
  return panes;
}

// A wall without the parts under the panes.
Pieces opened(const Scene& scene, const Polygon& wall, const std::vector<Loop>& panes, double near) {
  Pieces pieces;
  Polygon part = wall;
  if (std::optional<Loop> cut = with_holes(scene, wall.corners, panes, near)) {
    part.corners = std::move(*cut);
    pieces.polygons.push_back(std::move(part));
    return pieces;
  }
  for (const std::vector<Point>& piece : in_pieces(scene, wall.corners, panes, near)) {
    part.corners.clear();
    for (const Point& corner : piece) {
      part.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size() + pieces.new_vertices.size()));
      pieces.new_vertices.push_back(corner);
    }
    pieces.polygons.push_back(part);
  }
  return pieces;
}

constexpr double thickest_pane = 0.05;    // meters
constexpr double parallel_within = 1e-4;  // 1 less the cosine of the angle between planes: 0.8 degrees

// The share of a face that has to lie opposite faces of the other side: corners may be off by a hundredth of its size.
constexpr double least_opposite = 0.96;

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
    faces.push_back({p, triangles_of(corners), front_normal(scene, p), area_centroid(corners), polygon_area(scene, p)});
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
  std::vector<Opposite> pairs;
  for (std::size_t a = 0; a < faces.size(); ++a) {
    const Face& face = faces[a];
    const Vector margin = thickest_pane * face.normal.cwiseAbs();
    const Box& box = tree.face(a).box;
    const FaceQuery query{Box(box.min() - margin, box.max() + margin),
                          FaceQuery::any,
                          face.normal,
                          std::sqrt(2 * parallel_within),
                          face.normal.dot(face.middle),
                          2 * thickest_pane};
    tree.for_each(query, [&](std::size_t b) {
      const Face& other = faces[b];
      if (b <= a || scene.polygons[face.polygon].material != scene.polygons[other.polygon].material) return;
      const double depth = depth_between(face, other);
      if (!(depth >= 1e-5 && depth <= thickest_pane)) return;  // nearer faces are in one plane
      const double area = common_area(face.triangles, other.triangles, face.normal);
      // Neighbors that overlap at an edge have less in common.
      if (!(area > (1 - least_opposite) * std::min(face.area, other.area))) return;
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
    if (!is_whole || pane.depth > 0.1 * std::sqrt(area)) return {};
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

Scene with_openings_cut(Scene scene) {
  const auto count = static_cast<PolygonIndex>(scene.polygons.size());
  bool any = false;
  for (PolygonIndex p = 0; p < count && !any; ++p) any = is_opening(scene, p);
  if (!any) return scene;
  const Coverings coverings = find_coverings(scene, kept_sides(scene, Sides::both));
  const double near = weld_distance(scene);
  std::vector<ModelFace> cut;
  std::vector<Polygon> polygons;
  for (PolygonIndex p = 0; p < count; ++p) {
    const std::vector<Loop> panes = panes_over(scene, coverings, p);
    if (panes.empty()) {
      polygons.push_back(scene.polygons[p]);
      continue;
    }
    cut.push_back(model_face(scene, scene.polygons[p]));
    Pieces pieces = opened(scene, scene.polygons[p], panes, near);
    scene.vertices.insert(scene.vertices.end(), pieces.new_vertices.begin(), pieces.new_vertices.end());
    for (Polygon& part : pieces.polygons) polygons.push_back(std::move(part));
  }
  scene.polygons = std::move(polygons);
  if (cut.empty()) return scene;
  const std::string what = listed(scene, cut) + " under a clear one in the same plane: opened there";
  scene.diagnostics.push_back({DiagnosticCode::overlapping_faces, what, cut.size(), std::move(cut)});
  return scene;
}

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
