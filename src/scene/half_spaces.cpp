#include "scene/half_spaces.h"

#include "scene/extent.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

constexpr double plane_tolerance = 1e-6;  // of the scene's extent

std::vector<Point> used_vertices(const Scene& scene) {
  std::vector<std::uint8_t> used(scene.vertices.size(), 0);
  for (const Polygon& polygon : scene.polygons) {
    for (const std::uint32_t corner : polygon.corners) used[corner] = 1;
  }
  std::vector<Point> points;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) points.push_back(scene.vertices[v]);
  }
  return points;
}

// A binary tree of boxes around points: children of node k are 2 k + 1 and 2 k + 2.
class PointTree {
 public:
  explicit PointTree(std::vector<Point> points) : points_(std::move(points)) { build(0, 0, points_.size()); }

  // Does a point lie farther than `height` along a direction of length 1? The box of a node bounds its points from both
  // sides: where it lies on one side as a whole no point is looked at. O(log n) for most planes.
  bool reaches(const Vector& direction, double height) const {
    return reaches(0, 0, points_.size(), direction, height);
  }

 private:
  static constexpr std::size_t few = 8;

  void build(std::size_t node, std::size_t begin, std::size_t end) {
    if (boxes_.size() <= node) boxes_.resize(node + 1);
    for (std::size_t k = begin; k < end; ++k) boxes_[node].extend(points_[k]);
    if (end - begin <= few) return;
    Eigen::Index axis = 0;
    boxes_[node].sizes().maxCoeff(&axis);
    const auto at = [&](std::size_t k) { return points_.begin() + static_cast<std::ptrdiff_t>(k); };
    const std::size_t middle = (begin + end) / 2;
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const Point& a, const Point& b) { return a[axis] < b[axis]; });
    build(2 * node + 1, begin, middle);
    build(2 * node + 2, middle, end);
  }

  bool reaches(std::size_t node, std::size_t begin, std::size_t end, const Vector& direction, double height) const {
    if (begin == end) return false;
    const double center = direction.dot(boxes_[node].center());
    const double half = 0.5 * direction.cwiseAbs().dot(boxes_[node].sizes());
    if (center + half <= height) return false;
    if (center - half > height) return true;
    if (end - begin <= few) {
      return std::any_of(points_.begin() + static_cast<std::ptrdiff_t>(begin),
                         points_.begin() + static_cast<std::ptrdiff_t>(end),
                         [&](const Point& point) { return direction.dot(point) > height; });
    }
    const std::size_t middle = (begin + end) / 2;
    return reaches(2 * node + 2, middle, end, direction, height) ||
           reaches(2 * node + 1, begin, middle, direction, height);
  }

  std::vector<Point> points_;
  std::vector<Box> boxes_;
};

}  // namespace

HalfSpaces occupied_half_spaces(const Scene& scene) {
  const PointTree points(used_vertices(scene));
  const double tolerance = plane_tolerance * extent_of(scene);
  HalfSpaces occupied{std::vector<std::uint8_t>(scene.polygons.size(), 0),
                      std::vector<std::uint8_t>(scene.polygons.size(), 0)};
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Vector normal = front_normal(scene, p);
    const double height = normal.dot(scene.vertices[scene.polygons[p].corners[0]]);
    occupied.before[p] = points.reaches(normal, height + tolerance);
    occupied.behind[p] = points.reaches(-normal, tolerance - height);
  }
  return occupied;
}

}  // namespace patchlight
