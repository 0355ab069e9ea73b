#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// Boxes in a row, for example those of a polygon's corners or edges along its outline, under a binary tree of the
/// boxes around neighbors: a search passes over whole stretches of the outline.
class BoxRow {
 public:
  explicit BoxRow(std::span<const Box> boxes);

  /// The first place from `begin` on at which `is_sought(place)` holds. Stretches whose box `is_out(box)` are passed
  /// over; it has to be true of a box only when it is so of all within.
  template <class IsOut, class IsSought>
  std::optional<std::size_t> first(std::size_t begin, const IsOut& is_out, const IsSought& is_sought) const {
    return first_below(1, 0, leaves_, begin, is_out, is_sought);
  }

  /// Takes one out, so that it is never found again. O(log n).
  void remove(std::size_t place);

 private:
  template <class IsOut, class IsSought>
  std::optional<std::size_t> first_below(std::size_t node, std::size_t low, std::size_t width, std::size_t begin,
                                         const IsOut& is_out, const IsSought& is_sought) const {
    if (low + width <= begin || nodes_[node].isEmpty() || is_out(nodes_[node])) return std::nullopt;
    if (width == 1) return is_sought(low) ? std::optional(low) : std::nullopt;
    const auto left = first_below(2 * node, low, width / 2, begin, is_out, is_sought);
    return left ? left : first_below(2 * node + 1, low + width / 2, width / 2, begin, is_out, is_sought);
  }

  std::size_t leaves_;      // a power of two
  std::vector<Box> nodes_;  // the parts of node k are nodes 2 k and 2 k + 1; the whole is node 1
};

inline BoxRow::BoxRow(std::span<const Box> boxes) : leaves_(std::bit_ceil(boxes.size())), nodes_(2 * leaves_) {
  for (std::size_t k = 0; k < boxes.size(); ++k) nodes_[leaves_ + k] = boxes[k];
  for (std::size_t k = leaves_; k-- > 1;) nodes_[k] = nodes_[2 * k].merged(nodes_[2 * k + 1]);
}

inline void BoxRow::remove(std::size_t place) {
  nodes_[leaves_ + place].setEmpty();
  for (std::size_t k = (leaves_ + place) / 2; k > 0; k /= 2) nodes_[k] = nodes_[2 * k].merged(nodes_[2 * k + 1]);
}

/// The box, made larger by a margin on all sides.
inline Box with_margin(const Box& box, double margin) {
  const Vector all = Vector::Constant(margin);
  return {box.min() - all, box.max() + all};
}

/// The properties of a face for searches.
struct FlatFace {
  Box box;
  double area = 0;  ///< m^2
  Vector normal;    ///< unit, or zero where the face has no area
  Point mean;       ///< of its corners
  Point farthest;   ///< the corner farthest from there
};

/// The flat face of a polygon with these corners.
FlatFace flat_face(const std::vector<Point>& corners);

/// The box that a face has to meet, the largest area it may have, and a plane with a tolerance: any by default.
struct FaceQuery {
  static constexpr double any = std::numeric_limits<double>::infinity();
  Box box;
  double area = any;
  Vector normal = Vector::UnitZ();  ///< unit
  double tilt = any;                ///< how far the unit normal of a face may be from this one, or from its reverse
  double offset = 0;                ///< normal . x of the plane's points
  double tolerance = any;

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
/// place, for queries of the faces in a box.
enum class FaceOrder : std::uint8_t { by_direction, by_place };

/// A tree over faces. O(n log n) to build. The order decides the cost of a search, and the order of its visits.
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

/// The tree of all polygons of a scene, in order.
FaceTree tree_of_faces(const Scene& scene, FaceOrder order = FaceOrder::by_direction);

/// Per polygon 1 when a vertex of the scene lies before its front, and behind it, by more than 1e-6 of the scene's
/// extent.
struct HalfSpaces {
  std::vector<std::uint8_t> before;
  std::vector<std::uint8_t> behind;
};

/// O(n log n) for most scenes of n vertices and polygons.
HalfSpaces occupied_half_spaces(const Scene& scene);

/// The straight pieces along which a plane, through `on` across `normal`, cuts the polygons of a scene; nothing of
/// polygons that lie in it.
std::vector<std::array<Point, 2>> section_of(const Scene& scene, const Point& on, const Vector& normal);

}  // namespace patchlight
