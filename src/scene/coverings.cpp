#include "patchlight/scene/coverings.h"

#include "patchlight/scene/triangulate.h"

#include "scene/problem_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <unsupported/Eigen/BVH>
#include <vector>

namespace patchlight {
namespace {

// Heights above a plane as shares of the scene's extent: what counts as in the plane, and what as on the other's place.
// They are those by which shadow rays tell before from behind.
constexpr double in_plane_tolerance = 3e-7;
constexpr double same_height_tolerance = 1e-9;

// Overlaps smaller than this share of the smaller polygon are rounding at a common edge.
constexpr double least_overlap = 1e-6;

constexpr double parallel = 0.999;

struct Face {
  std::vector<Point> corners;
  std::vector<std::array<Point, 3>> triangles;
  Vector normal;
  Box box;
  double area = 0;
  std::array<bool, 2> emits{};  // per side
};

Face face_of(const Scene& scene, PolygonIndex p, bool emit_from_back) {
  Face face{corner_points(scene, p), {}, {}, {}, 0, {}};
  for (const auto& [a, b, c] : triangulate(face.corners)) {
    face.triangles.push_back({face.corners[a], face.corners[b], face.corners[c]});
  }
  const Vector area = area_vector(face.corners);
  face.area = area.norm();
  face.normal = area / face.area;
  for (const Point& corner : face.corners) face.box.extend(corner);
  const Polygon& polygon = scene.polygons[p];
  const auto emits = [&](MaterialIndex material) { return (scene.materials[material].exitance > 0).any(); };
  face.emits[0] = emits(polygon.material);
  face.emits[1] = polygon.back_material ? emits(*polygon.back_material) : emit_from_back && face.emits[0];
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

// The height of `upper` along the normal of `lower` where both lie in one plane.
std::optional<double> height_in_plane(const Face& lower, const Face& upper, double tolerance) {
  if (std::abs(lower.normal.dot(upper.normal)) < parallel) return {};
  const bool lower_is_larger = lower.area >= upper.area;
  const Face& plane = lower_is_larger ? lower : upper;
  const Face& other = lower_is_larger ? upper : lower;
  double sum = 0;
  for (const Point& corner : other.corners) {
    const double height = plane.normal.dot(corner - plane.corners[0]);
    if (std::abs(height) > tolerance) return {};
    sum += height;
  }
  const double mean = sum / static_cast<double>(other.corners.size());
  return lower_is_larger ? mean : -mean * (lower.normal.dot(upper.normal) > 0 ? 1 : -1);
}

struct FaceSide {
  PolygonIndex polygon;
  Side side;
};

// Does `a` lie over `b` when both are at one height?
bool comes_first(const std::vector<Face>& faces, const FaceSide& a, const FaceSide& b) {
  const Face& first = faces[a.polygon];
  const Face& second = faces[b.polygon];
  const auto larger = [](const Face& p, const Face& q) { return p.area > (1 + 1e-9) * q.area; };
  const auto rank = [](const Face& face, const FaceSide& of, bool is_larger) {
    return std::make_tuple(!face.emits[static_cast<std::size_t>(of.side)], is_larger, of.polygon);
  };
  return rank(first, a, larger(first, second)) < rank(second, b, larger(second, first));
}

bool is_kept(const KeptSides& kept, const FaceSide& of) {
  return (of.side == Side::front ? kept.front : kept.back)[of.polygon] != 0;
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
  if (lower == upper || !meet(faces[lower].box, faces[upper].box)) return false;
  const auto height = height_in_plane(faces[lower], faces[upper], slack());
  if (!height) return false;
  const bool same_front = faces[lower].normal.dot(faces[upper].normal) > 0;
  for (const Side side : {Side::front, Side::back}) {
    const FaceSide below{lower, side};
    const FaceSide over{upper, (side == Side::front) == same_front ? Side::front : Side::back};
    if (!is_kept(kept, below) || !is_kept(kept, over)) continue;
    const double above = (side == Side::front ? 1 : -1) * *height / extent;
    const bool covers = std::abs(above) > same_height_tolerance ? above > 0 : comes_first(faces, over, below);
    if (!covers || !overlap(faces[lower], faces[upper])) continue;
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
    faces.push_back(face_of(scene, p, kept.emit_from_back));
    numbers.push_back(p);
    boxes.push_back(faces.back().box);
  }
  const Eigen::KdBVH<double, 3, PolygonIndex> tree(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());
  Search search{scene, kept, faces, bounds(scene).diagonal().norm(), {}};
  Eigen::BVIntersect(tree, tree, search);
  for (auto& covering : search.found.over) std::sort(covering.begin(), covering.end());
  return std::move(search.found);
}

std::vector<Problem> problems_with_overlaps(const Scene& scene, const Coverings& coverings) {
  std::vector<ProblemFace> faces;
  for (std::size_t k = 0; k < coverings.over.size(); k += 2) {
    if (coverings.over[k].empty() && coverings.over[k + 1].empty()) continue;
    faces.push_back(problem_face(scene, scene.polygons[k / 2]));
  }
  if (faces.empty()) return {};
  const std::size_t count = faces.size();
  const std::string what =
      listed(scene, faces) + (count == 1 ? " lies" : " lie") +
      " in part under another in the same plane; where they overlap a lamp counts before others, " +
      "then the smaller face, then the first";
  return {{ProblemKind::overlapping_faces, count, what, std::move(faces)}};
}

}  // namespace patchlight
