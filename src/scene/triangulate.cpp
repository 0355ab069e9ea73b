#include "patchlight/scene/triangulate.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace patchlight {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Twice the signed area of a triangle, positive when it turns like the polygon.
double turn(const Vector& normal, const Point& a, const Point& b, const Point& c) {
  return normal.dot((b - a).cross(c - a));
}

bool contains(const Vector& normal, const Point& a, const Point& b, const Point& c, const Point& x) {
  return turn(normal, a, b, x) >= 0 && turn(normal, b, c, x) >= 0 && turn(normal, c, a, x) >= 0;
}

// Does the direction from b to x lead into the angle at b between the edges to c and to a?
bool is_inside_angle(const Vector& normal, const Point& a, const Point& b, const Point& c, const Point& x) {
  return turn(normal, a, b, x) > 0 && turn(normal, b, c, x) > 0;
}

// Among the remaining corners, is the one at `k` an ear: does it turn outward, is no other corner inside it, and does
// no seam begin at its tip and lead through it?
bool is_ear(std::span<const Point> polygon, const std::vector<std::uint32_t>& left, std::size_t k,
            const Vector& normal) {
  const std::size_t n = left.size();
  const Point& a = polygon[left[(k + n - 1) % n]];
  const Point& b = polygon[left[k]];
  const Point& c = polygon[left[(k + 1) % n]];
  if (turn(normal, a, b, c) <= 0) return false;
  for (std::size_t other = 0; other + 3 < n; ++other) {
    const Point& x = polygon[left[(k + 2 + other) % n]];
    if (x == b) {
      const Point& before = polygon[left[(k + 1 + other) % n]];
      const Point& after = polygon[left[(k + 3 + other) % n]];
      if (is_inside_angle(normal, a, b, c, before) || is_inside_angle(normal, a, b, c, after)) return false;
    }
    if (x == a || x == b || x == c) continue;
    if (contains(normal, a, b, c, x)) return false;
  }
  return true;
}

// Where rounding leaves no ear: the corner that turns least, outward or inward.
std::size_t flattest(std::span<const Point> polygon, const std::vector<std::uint32_t>& left, const Vector& normal) {
  const std::size_t n = left.size();
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < n; ++k) {
    const double amount =
        std::abs(turn(normal, polygon[left[(k + n - 1) % n]], polygon[left[k]], polygon[left[(k + 1) % n]]));
    if (amount < least) least = amount, best = k;
  }
  return best;
}

}  // namespace

bool is_convex(std::span<const Point> polygon) {
  const Vector normal = area_vector(polygon);
  const std::size_t n = polygon.size();
  for (std::size_t k = 0; k < n; ++k) {
    if (turn(normal, polygon[k], polygon[(k + 1) % n], polygon[(k + 2) % n]) < 0) return false;
  }
  return true;
}

std::vector<Triangle> triangulate(std::span<const Point> polygon) {
  const Vector normal = area_vector(polygon);
  if (polygon.size() == 4 && is_convex(polygon)) {
    const bool shorter_02 = (polygon[2] - polygon[0]).squaredNorm() <= (polygon[3] - polygon[1]).squaredNorm();
    if (shorter_02) return {{0, 1, 2}, {0, 2, 3}};
    return {{1, 2, 3}, {1, 3, 0}};
  }

  // Ear clipping (Meisters 1975). Where rounding leaves no ear, the flattest corner is cut off: the result is complete.
  std::vector<std::uint32_t> left;
  for (std::uint32_t k = 0; k < polygon.size(); ++k) left.push_back(k);
  std::vector<Triangle> triangles;
  while (left.size() >= 3) {
    std::size_t ear = 0;
    while (ear < left.size() && left.size() > 3 && !is_ear(polygon, left, ear, normal)) ++ear;
    if (ear == left.size()) ear = flattest(polygon, left, normal);
    const std::size_t n = left.size();
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

}  // namespace patchlight
