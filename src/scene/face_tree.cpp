#include "scene/face_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace patchlight {
namespace {

constexpr std::uint32_t faces_in_a_leaf = 4;

// Unit normals that differ by less belong together: 6 degrees.
constexpr double one_direction = 0.1;

// Does some point of the box come as near to the plane?
bool comes_near(const Box& box, const FaceQuery& query) {
  const double height = query.normal.dot(box.center()) - query.offset;
  const double reach = query.normal.cwiseAbs().dot(box.sizes()) / 2;
  return std::abs(height) <= reach + query.tolerance;
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

// By direction first if that is asked for, then along the axis on which the means or the farthest corners spread most.
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
  if (node.normals.sizes().maxCoeff() > one_direction) return halved_by(&FlatFace::normal, node.normals);
  if (node.means.sizes().maxCoeff() >= node.farthest.sizes().maxCoeff()) return halved_by(&FlatFace::mean, node.means);
  return halved_by(&FlatFace::farthest, node.farthest);
}

void FaceTree::add_nodes(std::uint32_t begin, std::uint32_t end) {
  const std::size_t own = nodes_.size();
  nodes_.push_back(node_of(begin, end));
  if (end - begin <= faces_in_a_leaf) {
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

}  // namespace patchlight
