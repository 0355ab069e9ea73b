#include "input/cut_openings.h"

#include "input/joined_rings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

using Corners = std::vector<Point>;

const Point& next_of(const Corners& ring, std::size_t k) { return ring[(k + 1) % ring.size()]; }

// On the segment from a to b, up to the tolerance.
bool is_on(const Point& point, const Point& a, const Point& b, double tolerance) {
  const Vector along = b - a;
  const double length = along.norm();
  if (!(length > tolerance)) return false;
  const double at = along.dot(point - a) / length;
  return at >= -tolerance && at <= length + tolerance && (point - a - at / length * along).norm() <= tolerance;
}

// The place of an edge of the outline, and of one of the opening on it that runs the same way.
std::optional<std::pair<std::size_t, std::size_t>> common_edge(const Corners& outline, const Corners& opening,
                                                               double tolerance) {
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& a = outline[k];
    const Point& b = next_of(outline, k);
    for (std::size_t j = 0; j < opening.size(); ++j) {
      const Point& from = opening[j];
      const Point& to = next_of(opening, j);
      if (!is_on(from, a, b, tolerance) || !is_on(to, a, b, tolerance)) continue;
      if ((b - a).dot(to - from) > 0 && (to - from).norm() > tolerance) return std::pair(k, j);
    }
  }
  return std::nullopt;
}

// From the outline's edge around the opening, the other way, and back to the edge.
Corners with_notch(const Corners& outline, const Corners& opening, std::size_t k, std::size_t j) {
  Corners result(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(k + 1));
  for (std::size_t step = 0; step < opening.size(); ++step)
    result.push_back(opening[(j + opening.size() - step) % opening.size()]);
  result.insert(result.end(), outline.begin() + static_cast<std::ptrdiff_t>(k + 1), outline.end());
  return result;
}

// Without corners that repeat the one before, and without ways that go back on themselves.
Corners without_ways_back(Corners ring, double tolerance) {
  for (std::size_t k = 0, sound = 0; ring.size() > 2 && sound < ring.size();) {
    const std::size_t n = ring.size();
    const Point& before = ring[(k + n - 1) % n];
    const Point& after = ring[(k + 1) % n];
    const bool is_repeated = (ring[k] - before).norm() <= tolerance;
    const bool goes_back = (ring[k] - before).dot(after - ring[k]) < 0 &&
                           (is_on(after, before, ring[k], tolerance) || is_on(before, ring[k], after, tolerance));
    if (!is_repeated && !goes_back) {
      k = (k + 1) % n;
      ++sound;
      continue;
    }
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(k));
    k = (k + n - 2) % (n - 1);
    sound = 0;
  }
  return ring.size() > 2 ? ring : Corners{};
}

// Within the outline, or on an edge: a ray along x crosses its edges an odd number of times.
bool is_within(const Point& point, const Corners& outline, const Vector& normal, double tolerance) {
  const Vector x = normal.unitOrthogonal();
  const Vector y = normal.cross(x);
  bool is_odd = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& a = outline[k];
    const Point& b = next_of(outline, k);
    if (is_on(point, a, b, tolerance)) return true;
    const double above_a = y.dot(a - point);
    const double above_b = y.dot(b - point);
    if ((above_a > 0) == (above_b > 0)) continue;
    if (x.dot(a - point) + above_a / (above_a - above_b) * x.dot(b - a) > 0) is_odd = !is_odd;
  }
  return is_odd;
}

// In the plane of the outline, counter-clockwise around its normal.
Corners laid_into(Corners ring, const Point& on_plane, const Vector& normal) {
  for (Point& point : ring) point -= normal.dot(point - on_plane) * normal;
  if (area_vector(ring).dot(normal) < 0) std::reverse(ring.begin(), ring.end());
  return ring;
}

}  // namespace

std::vector<Point> joined_outline(const std::vector<std::vector<Point>>& rings) {
  if (rings.size() == 1) return rings[0];
  const Vector normal = area_vector(rings[0]).normalized();
  const Vector x = normal.unitOrthogonal();
  const Vector y = normal.cross(x);
  std::vector<std::vector<Eigen::Vector2d>> plane;
  for (const Corners& ring : rings) {
    auto& flat = plane.emplace_back();
    for (const Point& point : ring) flat.emplace_back(x.dot(point), y.dot(point));
  }
  Corners outline;
  for (const auto& [ring, corner] : joined_rings(plane).value_or(std::vector<RingCorner>{}))
    outline.push_back(rings[ring][corner]);
  return outline;
}

CutOutline without_openings(const std::vector<Point>& outline, const std::vector<std::vector<Point>>& openings,
                            double tolerance) {
  const Vector area = area_vector(outline);
  if (!(area.norm() > 0) || openings.empty()) return {outline, 0};
  const Vector normal = area.normalized();

  // 1. Nothing is left where the openings are as large as the outline.
  CutOutline cut{outline, 0};
  std::vector<Corners> rings;
  double open = 0;
  for (const Corners& opening : openings) {
    Corners ring = laid_into(opening, outline[0], normal);
    const bool is_inside = std::all_of(
        ring.begin(), ring.end(), [&](const Point& corner) { return is_within(corner, outline, normal, tolerance); });
    cut.uncut += is_inside ? 0 : 1;
    if (!is_inside) continue;
    open += area_vector(ring).norm();
    rings.push_back(std::move(ring));
  }
  constexpr double nothing = 1e-6;
  if (open >= (1 - nothing) * area.norm()) return {{}, 0};

  // 2. Notches, until no opening lies along an edge.
  std::vector<Corners> within;
  for (const Corners& ring : rings) {
    const auto common = common_edge(cut.corners, ring, tolerance);
    if (!common) {
      within.push_back(ring);
      continue;
    }
    cut.corners = without_ways_back(with_notch(cut.corners, ring, common->first, common->second), tolerance);
  }
  if (within.empty() || cut.corners.empty()) return cut;

  // 3. Seams to the others.
  within.insert(within.begin(), cut.corners);
  const Corners joined = joined_outline(within);
  if (joined.empty()) {
    cut.uncut += within.size() - 1;
  } else {
    cut.corners = joined;
  }
  return cut;
}

}  // namespace patchlight
