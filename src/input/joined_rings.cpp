#include "input/joined_rings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patchlight {
namespace {

using PlanePoint = Eigen::Vector2d;

struct Ring {
  std::vector<RingCorner> corners;
  std::vector<PlanePoint> places;
};

double turn_at(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

double twice_the_area(const Ring& ring) {
  double sum = 0;
  for (std::size_t k = 0; k < ring.places.size(); ++k)
    sum += turn_at(ring.places[0], ring.places[k], ring.places[(k + 1) % ring.places.size()]);
  return sum;
}

// Does the segment from a to b meet an edge of the ring that ends at neither?
bool meets(const Ring& ring, const PlanePoint& a, const PlanePoint& b) {
  for (std::size_t k = 0; k < ring.places.size(); ++k) {
    const PlanePoint& c = ring.places[k];
    const PlanePoint& d = ring.places[(k + 1) % ring.places.size()];
    if (c == a || c == b || d == a || d == b) continue;
    if (turn_at(a, b, c) * turn_at(a, b, d) <= 0 && turn_at(c, d, a) * turn_at(c, d, b) <= 0) return true;
  }
  return false;
}

// The outline, to the hole and back; nothing without a seam that meets neither these nor the others.
std::optional<Ring> with_hole(const Ring& outline, Ring hole, const std::vector<Ring>& others) {
  if (twice_the_area(outline) * twice_the_area(hole) > 0) {
    std::reverse(hole.corners.begin(), hole.corners.end());
    std::reverse(hole.places.begin(), hole.places.end());
  }
  double shortest = std::numeric_limits<double>::infinity();
  std::size_t from = 0, to = 0;
  for (std::size_t i = 0; i < outline.places.size(); ++i) {
    for (std::size_t j = 0; j < hole.places.size(); ++j) {
      const PlanePoint& a = outline.places[i];
      const PlanePoint& b = hole.places[j];
      if (!((b - a).norm() < shortest) || a == b || meets(outline, a, b) || meets(hole, a, b)) continue;
      if (std::any_of(others.begin(), others.end(), [&](const Ring& other) { return meets(other, a, b); })) continue;
      shortest = (b - a).norm();
      from = i;
      to = j;
    }
  }
  if (!std::isfinite(shortest)) return std::nullopt;
  Ring ring;
  const auto add = [&ring](const Ring& source, std::size_t k) {
    ring.corners.push_back(source.corners[k % source.corners.size()]);
    ring.places.push_back(source.places[k % source.places.size()]);
  };
  for (std::size_t i = 0; i <= from; ++i) add(outline, i);
  for (std::size_t j = 0; j <= hole.corners.size(); ++j) add(hole, to + j);
  for (std::size_t i = from; i < outline.corners.size(); ++i) add(outline, i);
  return ring;
}

}  // namespace

std::optional<std::vector<RingCorner>> joined_rings(const std::vector<std::vector<Eigen::Vector2d>>& rings) {
  constexpr std::size_t most_corners = 2000;
  std::vector<Ring> all;
  std::size_t corners = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    if (rings[r].size() < 3) return std::nullopt;
    corners += rings[r].size();
    Ring ring;
    for (std::size_t k = 0; k < rings[r].size(); ++k) ring.corners.push_back({r, k});
    ring.places = rings[r];
    all.push_back(std::move(ring));
  }
  if (all.empty() || corners > most_corners) return std::nullopt;
  // A hole that others hide from the outline is joined once these are.
  Ring joined = std::move(all[0]);
  std::vector<Ring> left(all.begin() + 1, all.end());
  while (!left.empty()) {
    bool is_any_joined = false;
    for (std::size_t k = 0; k < left.size() && !is_any_joined; ++k) {
      std::vector<Ring> others = left;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      std::optional<Ring> more = with_hole(joined, left[k], others);
      if (!more) continue;
      joined = std::move(*more);
      left = std::move(others);
      is_any_joined = true;
    }
    if (!is_any_joined) return std::nullopt;
  }
  return joined.corners;
}

}  // namespace patchlight
