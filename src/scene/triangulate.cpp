#include "scene/triangulate.h"

#include "base/tolerances.h"
#include "scene/face_tree.h"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>

namespace patchlight {
namespace {

using IndexTriangle = std::array<std::uint32_t, 3>;

constexpr std::uint32_t none = ~std::uint32_t{0};

// Does the direction from b to x lead into the angle at b between the edges to c and to a?
bool is_inside_angle(const Vector& normal, const Point& a, const Point& b, const Point& c, const Point& x) {
  return turn(normal, a, b, x) > 0 && turn(normal, b, c, x) > 0;
}

// A corner of the rest of a polygon, between its neighbors.
struct Corner {
  const Point& before;
  const Point& at;
  const Point& after;
};

// Ear clipping (Meisters 1975): an ear is a corner that turns outward, with no other corner in its triangle, and with
// no seam that begins at its tip and leads through it. Does `other`, no neighbor of `corner`, keep it from being one?
bool hinders(const Corner& other, const Corner& corner, const Vector& normal) {
  const auto& [a, b, c] = corner;
  const Point& x = other.at;
  if (x == b && (is_inside_angle(normal, a, b, c, other.before) || is_inside_angle(normal, a, b, c, other.after)))
    return true;
  if (x == a || x == b || x == c) return false;
  return contains(normal, a, b, c, x);
}

// Looks at all corners again and again, where there are few.
std::vector<IndexTriangle> triangles_of_few(std::span<const Point> polygon) {
  const Vector normal = area_vector(polygon);
  std::vector<std::uint32_t> left(polygon.size());
  std::iota(left.begin(), left.end(), 0U);
  const auto corner = [&](std::size_t k) {
    const std::size_t n = left.size();
    return Corner{polygon[left[(k + n - 1) % n]], polygon[left[k % n]], polygon[left[(k + 1) % n]]};
  };
  const auto turning = [&](std::size_t k) {
    const auto [a, b, c] = corner(k);
    return turn(normal, a, b, c);
  };
  const auto is_ear = [&](std::size_t k) {
    if (turning(k) <= 0) return false;
    for (std::size_t other = k + 2; other + 1 < k + left.size(); ++other) {
      if (hinders(corner(other), corner(k), normal)) return false;
    }
    return true;
  };
  std::vector<IndexTriangle> triangles;
  while (left.size() >= 3) {
    std::size_t ear = 0;
    while (ear < left.size() && left.size() > 3 && !is_ear(ear)) ++ear;
    if (ear == left.size()) {
      // Where rounding leaves no ear, the flattest corner is cut off: the result is complete.
      ear = 0;
      for (std::size_t k = 1; k < left.size(); ++k) {
        if (std::abs(turning(k)) < std::abs(turning(ear))) ear = k;
      }
    }
    const std::size_t n = left.size();
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

// Per corner the next one at its place, after the last one the first.
std::vector<std::uint32_t> same_places(std::span<const Point> points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto coordinates = [&](std::uint32_t k) { return std::array{points[k].x(), points[k].y(), points[k].z()}; };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return coordinates(a) < coordinates(b); });
  std::vector<std::uint32_t> next(points.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && points[order[end]] == points[order[begin]]) ++end;
    for (std::size_t k = begin; k < end; ++k) next[order[k]] = order[k + 1 < end ? k + 1 : begin];
  }
  return next;
}

// The same triangles of many corners. A corner is looked at again when one of its neighbors is cut off, or the corner
// that keeps it from being an ear.
class EarClipping {
 public:
  explicit EarClipping(std::span<const Point> polygon)
      : polygon_(polygon),
        normal_(area_vector(polygon)),
        boxes_(std::vector<Box>(polygon.begin(), polygon.end())),
        before_(polygon.size()),
        after_(polygon.size()),
        is_left_(polygon.size(), 1),
        is_ear_(polygon.size(), 0),
        at_same_place_(same_places(polygon)),
        hindered_by_(polygon.size(), none) {
    Box whole;
    for (const Point& corner : polygon) whole.extend(corner);
    rounding_ = tolerance_of_arithmetic * normal_.norm() * whole.diagonal().norm();
    const auto n = static_cast<std::uint32_t>(polygon.size());
    for (std::uint32_t k = 0; k < n; ++k) {
      before_[k] = (k + n - 1) % n;
      after_[k] = (k + 1) % n;
    }
    for (std::uint32_t k = 0; k < n; ++k) look_at(k);
  }

  std::vector<IndexTriangle> triangles() {
    std::vector<IndexTriangle> triangles;
    const std::size_t n = polygon_.size();
    for (std::size_t left = n; left > 3; --left) {
      while (first_ear_ < n && !is_ear_[first_ear_]) ++first_ear_;
      triangles.push_back(cut_off(first_ear_ < n ? static_cast<std::uint32_t>(first_ear_) : flattest()));
    }
    const auto last = static_cast<std::uint32_t>(std::find(is_left_.begin(), is_left_.end(), 1) - is_left_.begin());
    triangles.push_back({before_[last], last, after_[last]});
    return triangles;
  }

 private:
  // A corner that keeps this one from being an ear, which may be itself; nothing when it is one.
  std::optional<std::uint32_t> hindrance(std::uint32_t corner) const {
    const Corner own = at(corner);
    const std::array<Point, 3> triangle{own.before, own.at, own.after};
    if (turn(normal_, triangle[0], triangle[1], triangle[2]) <= 0) return corner;
    // turn(a, b, x) = (n x (b - a)) . (x - a)
    std::array<Vector, 3> inward;
    std::array<double, 3> least{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector edge = triangle[(k + 1) % 3] - triangle[k];
      inward[k] = normal_.cross(edge);
      least[k] = inward[k].dot(triangle[k]) - rounding_ * edge.norm();
    }
    const auto is_beside = [&](const Box& box) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector& n = inward[k];
        if (n.cwiseMax(0).dot(box.max()) + n.cwiseMin(0).dot(box.min()) < least[k]) return true;
      }
      return false;
    };
    const auto found = boxes_.first(0, is_beside, [&](std::size_t place) {
      const auto other = static_cast<std::uint32_t>(place);
      const bool is_neighbour = other == before_[corner] || other == corner || other == after_[corner];
      return !is_neighbour && hinders(at(other), own, normal_);
    });
    return found ? std::optional(static_cast<std::uint32_t>(*found)) : std::nullopt;
  }

  Corner at(std::uint32_t corner) const {
    return {polygon_[before_[corner]], polygon_[corner], polygon_[after_[corner]]};
  }

  void look_at(std::uint32_t corner) {
    if (!is_left_[corner]) return;
    const std::optional<std::uint32_t> by = hindrance(corner);
    is_ear_[corner] = by ? 0 : 1;
    if (!by) {
      first_ear_ = std::min<std::size_t>(first_ear_, corner);
      return;
    }
    hindered_.push_back({corner, hindered_by_[*by]});
    hindered_by_[*by] = static_cast<std::uint32_t>(hindered_.size() - 1);
  }

  // Updates a corner whose neighbor was cut off. Corners at one place check the neighbors of each other.
  void look_at_neighbour(std::uint32_t corner) {
    std::uint32_t other = corner;
    do {
      look_at(other);
      other = at_same_place_[other];
    } while (other != corner);
  }

  // The corner that turns least, outward or inward.
  std::uint32_t flattest() const {
    std::uint32_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 0; k < is_left_.size(); ++k) {
      if (!is_left_[k]) continue;
      const double amount = std::abs(turn(normal_, polygon_[before_[k]], polygon_[k], polygon_[after_[k]]));
      if (amount < least) least = amount, best = k;
    }
    return best;
  }

  IndexTriangle cut_off(std::uint32_t corner) {
    const std::uint32_t before = before_[corner];
    const std::uint32_t after = after_[corner];
    is_left_[corner] = 0;
    boxes_.remove(corner);
    is_ear_[corner] = 0;
    after_[before] = after;
    before_[after] = before;
    look_at_neighbour(before);
    look_at_neighbour(after);
    for (std::uint32_t k = hindered_by_[corner]; k != none; k = hindered_[k].next) {
      if (!is_ear_[hindered_[k].corner]) look_at(hindered_[k].corner);
    }
    return {before, corner, after};
  }

  std::span<const Point> polygon_;
  Vector normal_;
  double rounding_;  // of turn(), over the length of the edge
  BoxRow boxes_;     // of the corners that are left
  std::vector<std::uint32_t> before_, after_;
  std::vector<std::uint8_t> is_left_;
  std::vector<std::uint8_t> is_ear_;
  std::size_t first_ear_ = 0;                 // none comes before it
  std::vector<std::uint32_t> at_same_place_;  // the next one there, the first after the last
  struct Hindered {
    std::uint32_t corner, next;
  };
  std::vector<Hindered> hindered_;          // lists
  std::vector<std::uint32_t> hindered_by_;  // per corner the head of the list of those that it keeps from being ears
};

// True when nothing but an edge of a triangle lies before a line, up to the rounding of clip_to_half_space().
bool lies_beyond(const Triangle& triangle, const Point& on_line, const Vector& inward) {
  const double length = inward.norm();
  int on_it = 0;
  for (const Point& corner : triangle) {
    const Vector offset = corner - on_line;
    const double height = inward.dot(offset);
    const double nothing = tolerance_of_shapes * length * offset.norm();
    if (height > nothing) return false;
    on_it += height >= -nothing;
  }
  return on_it < 3;
}

double common_area_of(const Triangle& a, const Triangle& b, const Vector& normal) {
  // Inward normals of b's edges, whichever way b turns.
  const double turn = area_vector(b).dot(normal) > 0 ? 1 : -1;
  std::array<Vector, 3> inward;
  for (std::size_t k = 0; k < 3; ++k) {
    inward[k] = turn * normal.cross(b[(k + 1) % 3] - b[k]);
    if (lies_beyond(a, b[k], inward[k])) return 0;
  }
  std::vector<Point> left(a.begin(), a.end());
  for (std::size_t k = 0; k < 3 && left.size() > 2; ++k) left = clip_to_half_space(left, b[k], inward[k]);
  return left.size() > 2 ? area_vector(left).norm() : 0;
}

}  // namespace

double common_area(std::span<const Triangle> some, std::span<const Triangle> others, const Vector& normal,
                   double enough) {
  double area = 0;
  for (const Triangle& first : some) {
    for (const Triangle& second : others) {
      area += common_area_of(first, second, normal);
      if (area > enough) return area;
    }
  }
  return area;
}

std::vector<Triangle> triangles_of(std::span<const Point> polygon) {
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : triangulate(polygon)) triangles.push_back({polygon[a], polygon[b], polygon[c]});
  return triangles;
}

Point inner_point(std::span<const Point> polygon) {
  double largest = 0;
  Point middle = polygon[0];
  for (const auto& [a, b, c] : triangles_of(polygon)) {
    const double area = (b - a).cross(c - a).norm();
    if (area <= largest) continue;
    largest = area;
    middle = (a + b + c) / 3;
  }
  return middle;
}

bool is_convex(std::span<const Point> polygon) {
  const Vector normal = area_vector(polygon);
  const std::size_t n = polygon.size();
  for (std::size_t k = 0; k < n; ++k) {
    if (turn(normal, polygon[k], polygon[(k + 1) % n], polygon[(k + 2) % n]) < 0) return false;
  }
  return true;
}

std::vector<IndexTriangle> triangulate(std::span<const Point> polygon) {
  if (polygon.size() == 4 && is_convex(polygon)) {
    const bool shorter_02 = (polygon[2] - polygon[0]).squaredNorm() <= (polygon[3] - polygon[1]).squaredNorm();
    if (shorter_02) return {{0, 1, 2}, {0, 2, 3}};
    return {{1, 2, 3}, {1, 3, 0}};
  }
  // The trees pay from about 32 corners on.
  return polygon.size() <= 32 ? triangles_of_few(polygon) : EarClipping(polygon).triangles();
}

std::vector<std::array<Point, 4>> convex_pieces(std::span<const Point> polygon) {
  const Vector normal = area_vector(polygon);
  bool is_convex = polygon.size() == 4;
  for (std::size_t k = 0; is_convex && k < 4; ++k)
    is_convex = turn(normal, polygon[k], polygon[(k + 1) % 4], polygon[(k + 2) % 4]) > 0;
  if (is_convex) return {{polygon[0], polygon[1], polygon[2], polygon[3]}};
  std::vector<std::array<Point, 4>> pieces;
  for (const auto& [a, b, c] : triangles_of(polygon)) pieces.push_back({a, b, c, c});
  return pieces;
}

}  // namespace patchlight
