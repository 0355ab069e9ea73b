#include "patchlight/scene/coverings.h"

#include "patchlight/scene/triangulate.h"

#include "scene/extent.h"
#include "scene/problem_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unsupported/Eigen/BVH>
#include <vector>

namespace patchlight {
namespace {

// Overlaps smaller than this share of the smaller polygon are rounding at a common edge.
constexpr double least_overlap = 1e-6;

constexpr double parallel = 0.999;

struct Face {
  std::vector<Point> corners;
  std::vector<std::array<Point, 3>> triangles;
  Vector normal;
  Box box;
  double area = 0;
};

Face face_of(const Scene& scene, PolygonIndex p) {
  Face face{corner_points(scene, p), {}, {}, {}, 0};
  for (const auto& [a, b, c] : triangulate(face.corners)) {
    face.triangles.push_back({face.corners[a], face.corners[b], face.corners[c]});
  }
  const Vector area = area_vector(face.corners);
  face.area = area.norm();
  face.normal = area / face.area;
  for (const Point& corner : face.corners) face.box.extend(corner);
  return face;
}

double overlap(const std::array<Point, 3>& a, const std::array<Point, 3>& b, const Vector& normal) {
  std::vector<Point> left(a.begin(), a.end());
  // Inward normals of b's edges, whichever way b turns.
  const double turn = area_vector(b).dot(normal) > 0 ? 1 : -1;
  for (std::size_t k = 0; k < 3 && left.size() > 2; ++k) {
    left = clip_to_half_space(left, b[k], turn * normal.cross(b[(k + 1) % 3] - b[k]));
  }
  return left.size() > 2 ? area_vector(left).norm() : 0;
}

bool overlap(const Face& a, const Face& b) {
  double area = 0;
  for (const auto& first : a.triangles) {
    for (const auto& second : b.triangles) area += overlap(first, second, a.normal);
  }
  return area > least_overlap * std::min(a.area, b.area);
}

// The corners of the smaller one are measured over the plane of the larger one.
bool in_one_plane(const Face& smaller, const Face& larger, double tolerance) {
  return std::abs(smaller.normal.dot(larger.normal)) >= parallel &&
         std::all_of(smaller.corners.begin(), smaller.corners.end(), [&](const Point& corner) {
           return std::abs(larger.normal.dot(corner - larger.corners[0])) <= tolerance;
         });
}

// Does `a` lie over `b`? A strict order: of two polygons exactly one lies over the other.
bool comes_first(const std::vector<Face>& faces, PolygonIndex a, PolygonIndex b) {
  constexpr double rounding = 1 + 1e-9;
  if (faces[a].area > rounding * faces[b].area) return false;
  if (faces[b].area > rounding * faces[a].area) return true;
  return a < b;
}

bool is_kept(const KeptSides& kept, PolygonIndex polygon, Side side) {
  return (side == Side::front ? kept.front : kept.back)[polygon] != 0;
}

// Visits all pairs of polygons whose boxes meet.
struct Search {
  const Scene& scene;
  const KeptSides& kept;
  const std::vector<Face>& faces;
  double extent;
  Coverings found;

  double slack() const { return in_plane_tolerance * extent; }
  bool meet(Box a, const Box& b) const {
    const Vector margin = Vector::Constant(slack());
    return Box(a.min() - margin, a.max() + margin).intersects(b);
  }
  bool intersectVolumeVolume(const Box& a, const Box& b) const { return meet(a, b); }
  bool intersectVolumeObject(const Box& a, PolygonIndex b) const { return meet(a, faces[b].box); }
  bool intersectObjectVolume(PolygonIndex a, const Box& b) const { return meet(faces[a].box, b); }
  bool intersectObjectObject(PolygonIndex lower, PolygonIndex upper);
};

// Notes on which sides of `lower` the other lies. True would end the search.
bool Search::intersectObjectObject(PolygonIndex lower, PolygonIndex upper) {
  const Face& below = faces[lower];
  const Face& over = faces[upper];
  if (lower == upper || !meet(below.box, over.box) || !comes_first(faces, upper, lower)) return false;
  if (!in_one_plane(over, below, slack()) || !overlap(below, over)) return false;
  const bool same_front = below.normal.dot(over.normal) > 0;
  for (const Side side : {Side::front, Side::back}) {
    const Side other_side = (side == Side::front) == same_front ? Side::front : Side::back;
    if (!is_kept(kept, lower, side) || !is_kept(kept, upper, other_side)) continue;
    if (found.over.empty()) found.over.resize(2 * faces.size());
    found.over[2 * std::size_t{lower} + static_cast<std::size_t>(side)].push_back(upper);
  }
  return false;
}

}  // namespace

std::span<const PolygonIndex> Coverings::over_side(PolygonIndex polygon, Side side) const {
  if (over.empty()) return {};
  return over[2 * std::size_t{polygon} + static_cast<std::size_t>(side)];
}

Coverings find_coverings(const Scene& scene, const KeptSides& kept) {
  std::vector<Face> faces;
  std::vector<PolygonIndex> numbers;
  std::vector<Box> boxes;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    faces.push_back(face_of(scene, p));
    numbers.push_back(p);
    boxes.push_back(faces.back().box);
  }
  const Eigen::KdBVH<double, 3, PolygonIndex> tree(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());
  Search search{scene, kept, faces, extent_of(scene), {}};
  Eigen::BVIntersect(tree, tree, search);
  for (auto& covering : search.found.over) std::sort(covering.begin(), covering.end());
  return std::move(search.found);
}

std::vector<Problem> problems_with_overlaps(const Scene& scene, const Coverings& coverings) {
  std::vector<ProblemFace> faces;
  std::vector<ProblemFace> lamps;
  const auto emits = [&](MaterialIndex material) { return (scene.materials[material].exitance > 0).any(); };
  for (PolygonIndex p = 0; 2 * std::size_t{p} < coverings.over.size(); ++p) {
    const bool front = !coverings.over_side(p, Side::front).empty();
    const bool back = !coverings.over_side(p, Side::back).empty();
    const Polygon& polygon = scene.polygons[p];
    if (front || back) faces.push_back(problem_face(scene, polygon));
    if ((front && emits(polygon.material)) || (back && polygon.back_material && emits(*polygon.back_material))) {
      lamps.push_back(problem_face(scene, polygon));
    }
  }
  std::vector<Problem> problems;
  const auto add = [&](ProblemKind kind, std::vector<ProblemFace> concerned, const std::string& what) {
    if (concerned.empty()) return;
    const std::size_t count = concerned.size();
    const std::string text = listed(scene, concerned) + (count == 1 ? " lies" : " lie") + what;
    problems.push_back({kind, count, text, std::move(concerned)});
  };
  add(ProblemKind::covered_lamp, std::move(lamps),
      " in part under a smaller one in the same plane, or an equal one before it, and no light comes from there");
  add(ProblemKind::overlapping_faces, std::move(faces),
      " in part under another in the same plane; where they overlap the smaller one is seen, of equal ones the first");
  return problems;
}

}  // namespace patchlight
