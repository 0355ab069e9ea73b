#include "scene/face_tree.h"

#include "base/tolerances.h"
#include "scene/extent.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

// Does some point of the box come as near to the plane?
bool comes_near(const Box& box, const FaceQuery& query) {
  const double height = query.normal.dot(box.center()) - query.offset;
  const double reach = query.normal.cwiseAbs().dot(box.sizes()) / 2;
  return std::abs(height) <= reach + query.tolerance;
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

// Where the outline crosses the plane: a corner in the plane counts as above it.
std::vector<Point> crossings(const std::vector<Point>& corners, const Point& on, const Vector& normal) {
  std::vector<Point> found;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Point &a = corners[k], &b = corners[(k + 1) % corners.size()];
    const double from = (a - on).dot(normal), to = (b - on).dot(normal);
    if ((from < 0) != (to < 0)) found.push_back(a + from / (from - to) * (b - a));
  }
  return found;
}

}  // namespace

FlatFace flat_face(const std::vector<Point>& corners) {
  FlatFace face;
  const Vector area = area_vector(corners);
  face.area = area.norm();
  face.normal = area.normalized();
  Vector sum = Vector::Zero();
  for (const Point& corner : corners) {
    face.box.extend(corner);
    sum += corner - corners[0];
  }
  face.mean = corners[0] + sum / static_cast<double>(corners.size());
  face.farthest = *std::max_element(corners.begin(), corners.end(), [&](const Point& a, const Point& b) {
    return (a - face.mean).squaredNorm() < (b - face.mean).squaredNorm();
  });
  return face;
}

FaceTree::FaceTree(std::vector<FlatFace> faces, FaceOrder order)
    : faces_(std::move(faces)), kept_together_(order), order_(faces_.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (!order_.empty()) add_nodes(0, static_cast<std::uint32_t>(order_.size()));
}

bool FaceTree::may_hold(const Node& node, const FaceQuery& query) {
  const double tilt = query.tilt * query.tilt;
  return node.least_area <= query.area && node.box.intersects(query.box) &&
         (node.normals.squaredExteriorDistance(query.normal) <= tilt ||
          node.normals.squaredExteriorDistance(Vector(-query.normal)) <= tilt) &&
         comes_near(node.means, query) && comes_near(node.farthest, query);
}

FaceTree::Node FaceTree::node_of(std::uint32_t begin, std::uint32_t end) const {
  Node node{{}, {}, {}, {}, std::numeric_limits<double>::infinity(), begin, 0, 0};
  for (std::uint32_t k = begin; k < end; ++k) {
    const FlatFace& face = faces_[order_[k]];
    node.box.extend(face.box);
    node.normals.extend(face.normal);
    node.means.extend(face.mean);
    node.farthest.extend(face.farthest);
    node.least_area = std::min(node.least_area, face.area);
  }
  return node;
}

// Splits by direction first, if requested, down to 6 degrees. Then splits along the axis with the widest spread of
// means or of farthest corners.
std::uint32_t FaceTree::halve(const Node& node, std::uint32_t end) {
  const auto halved_by = [&](Vector FlatFace::*place, const Box& spread) {
    Eigen::Index axis = 0;
    spread.sizes().maxCoeff(&axis);
    const std::uint32_t middle = node.first + (end - node.first) / 2;
    std::nth_element(
        order_.begin() + node.first, order_.begin() + middle, order_.begin() + end,
        [&](std::uint32_t a, std::uint32_t b) { return (faces_[a].*place)[axis] < (faces_[b].*place)[axis]; });
    return middle;
  };
  if (kept_together_ == FaceOrder::by_place) return halved_by(&FlatFace::mean, node.means);
  if (node.normals.sizes().maxCoeff() > 0.1) return halved_by(&FlatFace::normal, node.normals);
  if (node.means.sizes().maxCoeff() >= node.farthest.sizes().maxCoeff()) return halved_by(&FlatFace::mean, node.means);
  return halved_by(&FlatFace::farthest, node.farthest);
}

void FaceTree::add_nodes(std::uint32_t begin, std::uint32_t end) {
  const std::size_t own = nodes_.size();
  nodes_.push_back(node_of(begin, end));
  if (end - begin <= 4) {
    nodes_[own].count = end - begin;
  } else {
    const std::uint32_t middle = halve(nodes_[own], end);
    add_nodes(begin, middle);
    add_nodes(middle, end);
  }
  nodes_[own].next = static_cast<std::uint32_t>(nodes_.size());
}

FaceTree tree_of_faces(const Scene& scene, FaceOrder order) {
  std::vector<FlatFace> faces;
  faces.reserve(scene.polygons.size());
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) faces.push_back(flat_face(corner_points(scene, p)));
  return FaceTree(std::move(faces), order);
}

HalfSpaces occupied_half_spaces(const Scene& scene) {
  const PointTree points(corner_points(scene, used_vertices(scene)));
  const double tolerance = tolerance_of_coordinates * extent_of(scene);
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

std::vector<std::array<Point, 2>> section_of(const Scene& scene, const Point& on, const Vector& normal) {
  std::vector<std::array<Point, 2>> pieces;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    // Along the line every second piece is within the polygon. Seams cross twice at one place, with nothing between.
    const Vector along = front_normal(scene, p).cross(normal);
    if (along.norm() < tolerance_of_coordinates * normal.norm()) continue;  // it lies in the plane
    std::vector<Point> found = crossings(corner_points(scene, p), on, normal);
    std::sort(found.begin(), found.end(), [&](const Point& a, const Point& b) { return a.dot(along) < b.dot(along); });
    for (std::size_t k = 0; k + 1 < found.size(); k += 2) pieces.push_back({found[k], found[k + 1]});
  }
  return pieces;
}

}  // namespace patchlight
