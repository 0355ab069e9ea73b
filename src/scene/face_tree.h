#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// What a search among flat faces looks at.
struct FlatFace {
  Box box;
  double area = 0;  ///< m^2
  Vector normal;    ///< unit, or zero where the face has no area
  Point mean;       ///< of its corners
  Point farthest;   ///< the corner farthest from there
};

/// Of a polygon with these corners.
FlatFace flat_face(const std::vector<Point>& corners);

/// A plane with a tolerance, the box that a face has to meet, and the largest area it may have.
struct FaceQuery {
  Box box;
  double area;
  Vector normal;  ///< unit
  double tilt;    ///< how far the unit normal of a face may be from this one, or from its reverse
  double offset;  ///< normal . x of the plane's points
  double tolerance;

  bool admits(const FlatFace& face) const {
    return face.area <= area && box.intersects(face.box) && is_near(face.mean) && is_near(face.farthest) &&
           is_parallel(face.normal);
  }
  bool is_parallel(const Vector& other) const {
    return (other - normal).squaredNorm() <= tilt * tilt || (other + normal).squaredNorm() <= tilt * tilt;
  }
  bool is_near(const Point& point) const { return std::abs(normal.dot(point) - offset) <= tolerance; }
};

/// Which faces a tree keeps together: those of one direction, for queries that ask for parallel ones, or those at one
/// place, for queries that ask for what a box meets.
enum class FaceOrder : std::uint8_t { by_direction, by_place };

/// A tree over faces. O(n log n) to build. The order changes what a search costs, and in which order it visits.
class FaceTree {
 public:
  explicit FaceTree(std::vector<FlatFace> faces, FaceOrder order = FaceOrder::by_direction);

  const FlatFace& face(std::size_t k) const { return faces_[k]; }

  /// Calls visit(k) for every face k that the query admits. Among them are all parallel ones whose
  /// corners lie in the plane.
  template <class Visit>
  void for_each(const FaceQuery& query, const Visit& visit) const {
    for (std::size_t n = 0; n < nodes_.size();) {
      const Node& node = nodes_[n];
      if (!may_hold(node, query)) {
        n = node.next;
        continue;
      }
      for (const std::uint32_t k : std::span(order_).subspan(node.first, node.count)) {
        if (query.admits(faces_[k])) visit(k);
      }
      ++n;
    }
  }

 private:
  // Parts follow their whole; `next` is the node after all of them. Leaves alone have faces.
  struct Node {
    Box box;  // of the faces
    Box normals, means, farthest;
    double least_area;
    std::uint32_t first, count;
    std::uint32_t next;
  };

  static bool may_hold(const Node& node, const FaceQuery& query);
  Node node_of(std::uint32_t begin, std::uint32_t end) const;
  std::uint32_t halve(const Node& node, std::uint32_t end);
  void add_nodes(std::uint32_t begin, std::uint32_t end);

  std::vector<FlatFace> faces_;
  FaceOrder kept_together_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// Of all polygons of a scene, in order.
FaceTree tree_of_faces(const Scene& scene, FaceOrder order = FaceOrder::by_direction);

}  // namespace patchlight
