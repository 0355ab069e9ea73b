#include "mesh/outline.h"

#include "base/tolerances.h"
#include "scene/simple_polygon.h"
#include "scene/triangulate.h"

#include <cassert>
#include <cmath>
#include <span>

namespace patchlight {

bool comes_before(const Point& a, const Point& b) {
  if (a.x() != b.x()) return a.x() < b.x();
  if (a.y() != b.y()) return a.y() < b.y();
  return a.z() < b.z();
}

std::uint32_t parts_of(const Point& from, const Point& to, double max_edge) {
  // An edge of n max_edge has n parts, whatever the rounding of its length.
  return static_cast<std::uint32_t>(std::max(1.0, std::ceil((to - from).norm() / max_edge - tolerance_of_shapes)));
}

Outline make_outline(std::vector<Point> corners, const Vector& normal, double max_edge) {
  Outline outline{.corners = std::move(corners), .parts = {}, .normal = normal};
  const std::size_t n = outline.corners.size();
  outline.parts.reserve(n);
  for (std::size_t k = 0; k < n; ++k) {
    outline.parts.push_back(parts_of(outline.corners[k], outline.corners[(k + 1) % n], max_edge));
  }
  return outline;
}

bool is_quad_grid(const Outline& outline) {
  const auto& parts = outline.parts;
  return outline.lines.empty() && parts.size() == 4 && parts[0] == parts[2] && parts[1] == parts[3] &&
         is_convex(outline.corners);
}

Grading grading_of_edge(const Outline& outline, std::size_t edge) {
  if (outline.is_graded.empty()) return {};
  assert(outline.is_graded.size() == 4);
  return {outline.is_graded[(edge + 3) % 4] != 0, outline.is_graded[(edge + 1) % 4] != 0};
}

double share_of_edge(std::uint32_t index, std::uint32_t parts, Grading grading) {
  // From the nearer end, so that both halves have the same parts.
  if (grading.at_from && grading.at_to && 2 * index > parts) return 1 - share_of_edge(parts - index, parts, grading);
  const double t = static_cast<double>(index) / parts;
  if (grading.at_from && grading.at_to) return (1 - std::cos(std::numbers::pi * t)) / 2;
  if (grading.at_from) return 1 - std::cos(std::numbers::pi / 2 * t);
  if (grading.at_to) return std::sin(std::numbers::pi / 2 * t);
  return t;
}

Point edge_point(const Point& from, const Point& to, std::uint32_t index, std::uint32_t parts, Grading grading) {
  if (index == 0) return from;
  if (index == parts) return to;
  if (comes_before(to, from)) return edge_point(to, from, parts - index, parts, {grading.at_to, grading.at_from});
  return from + share_of_edge(index, parts, grading) * (to - from);
}

std::vector<Point> boundary_points(const Outline& outline) {
  std::vector<Point> points;
  const std::size_t n = outline.corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    for (std::uint32_t i = 0; i < outline.parts[k]; ++i) {
      points.push_back(edge_point(outline.corners[k], outline.corners[(k + 1) % n], i, outline.parts[k],
                                  grading_of_edge(outline, k)));
    }
  }
  return points;
}

namespace {

// A corner of one of the outlines with many of them, and where its neighbors are.
struct Occurrence {
  Point at, before, after;
  PolygonIndex polygon;
  std::size_t corner;
};

bool is_before(const Occurrence& a, const Occurrence& b) {
  if (a.at != b.at) return comes_before(a.at, b.at);
  return std::pair(a.polygon, a.corner) < std::pair(b.polygon, b.corner);
}

double turn_at(const Point& before, const Point& at, const Point& after) {
  const Vector in = at - before;
  const Vector out = after - at;
  return std::atan2(in.cross(out).norm(), in.dot(out));
}

// Sorted by position, then by polygon.
std::vector<Occurrence> occurrences_in(const Scene& scene, const std::vector<std::uint8_t>& has_many) {
  std::vector<Occurrence> all;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!has_many[p]) continue;
    const std::vector<Point> points = outline_corners(scene, p);
    const std::size_t n = points.size();
    for (std::size_t k = 0; k < n; ++k) all.push_back({points[k], points[(k + n - 1) % n], points[(k + 1) % n], p, k});
  }
  std::sort(all.begin(), all.end(), is_before);
  return all;
}

// Per occurrence: does a polygon with few corners have one at its place?
std::vector<std::uint8_t> met_by_others(const Scene& scene, const std::vector<std::uint8_t>& has_many,
                                        std::span<const Occurrence> all) {
  std::vector<std::uint8_t> met(all.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (has_many[p]) continue;
    for (const std::uint32_t corner : scene.polygons[p].corners) {
      const Point& point = scene.vertices[corner];
      auto found = std::lower_bound(all.begin(), all.end(), point,
                                    [](const Occurrence& a, const Point& b) { return comes_before(a.at, b); });
      for (; found != all.end() && found->at == point; ++found) met[static_cast<std::size_t>(found - all.begin())] = 1;
    }
  }
  return met;
}

// Do the faces that have a corner at one place all go through it between the same neighbors?
bool is_on_one_run(std::span<const Occurrence> here) {
  if (here.size() > 2) return false;
  const Occurrence& a = here.front();
  const Occurrence& b = here.back();
  if (here.size() == 2 && a.polygon == b.polygon) return false;
  const bool same = (a.before == b.before && a.after == b.after) || (a.before == b.after && a.after == b.before);
  return same && turn_at(a.before, a.at, a.after) <= std::numbers::pi / 12;
}

double width_of(const Scene& scene, PolygonIndex polygon) {
  const std::vector<Point> points = outline_corners(scene, polygon);
  double perimeter = 0;
  for (std::size_t k = 0; k < points.size(); ++k) perimeter += (points[(k + 1) % points.size()] - points[k]).norm();
  return 4 * area_vector(points).norm() / perimeter;
}

// Corners that follow each other, with the edges between them, and coarser ones in their place.
class Run {
 public:
  Run(std::vector<Point> points, double tolerance);
  std::vector<Point> coarse() const;

 private:
  std::size_t last() const { return points_.size() - 1; }
  bool fits(std::size_t from, std::size_t to) const;
  std::size_t farthest_from(std::size_t from) const;
  std::vector<std::size_t> kept() const;
  std::vector<std::size_t> evenly(std::size_t chords) const;
  Vector lost_area(std::size_t from, std::size_t to) const;

  std::vector<Point> points_;
  std::vector<double> turned_;  // up to and with each corner
  double tolerance_;            // of chords: half of what the outline may deviate, as corners are moved by the rest
};

Run::Run(std::vector<Point> points, double tolerance)
    : points_(std::move(points)), turned_(points_.size(), 0), tolerance_(tolerance) {
  for (std::size_t k = 1; k < last(); ++k)
    turned_[k] = turned_[k - 1] + turn_at(points_[k - 1], points_[k], points_[k + 1]);
}

// Is no corner between the two farther from their chord than the tolerance, and does it turn little?
bool Run::fits(std::size_t from, std::size_t to) const {
  if (turned_[to - 1] - turned_[from] > std::numbers::pi / 6) return false;
  const Vector chord = points_[to] - points_[from];
  const double length = chord.norm();
  if (!(length > 0)) return false;
  for (std::size_t k = from + 1; k < to; ++k) {
    if (chord.cross(points_[k] - points_[from]).norm() > tolerance_ * length) return false;
  }
  return true;
}

// The last corner that is found by doubling and then halving steps: what fits once need not fit for all shorter chords.
std::size_t Run::farthest_from(std::size_t from) const {
  std::size_t to = from + 1;
  std::size_t step = 1;
  for (; to + step <= last() && fits(from, to + step); step *= 2) to += step;
  for (; step > 0; step /= 2) {
    if (to + step <= last() && fits(from, to + step)) to += step;
  }
  return to;
}

// Chords with equally many edges each; nothing where one of them does not fit.
std::vector<std::size_t> Run::evenly(std::size_t chords) const {
  std::vector<std::size_t> ends{0};
  for (std::size_t k = 1; k <= chords; ++k) {
    ends.push_back(k * last() / chords);
    if (!fits(ends[k - 1], ends[k])) return {};
  }
  return ends;
}

std::vector<std::size_t> Run::kept() const {
  std::vector<std::size_t> ends{0};
  while (ends.back() < last()) ends.push_back(farthest_from(ends.back()));
  const std::vector<std::size_t> even = evenly(ends.size() - 1);
  return even.empty() ? ends : even;
}

// The vector area between the run and a chord of it.
Vector Run::lost_area(std::size_t from, std::size_t to) const {
  Vector twice = Vector::Zero();
  for (std::size_t k = from + 1; k < to; ++k)
    twice += (points_[k] - points_[from]).cross(points_[k + 1] - points_[from]);
  return twice / 2;
}

std::vector<Point> Run::coarse() const {
  std::vector<std::size_t> ends = kept();
  const Vector whole = lost_area(0, last());
  const bool straight = whole.norm() <= tolerance_of_arithmetic * (points_.back() - points_.front()).squaredNorm();
  if (ends.size() == 2 && !straight) ends = evenly(2);  // one is there to be moved
  if (ends.empty() || ends.size() == points_.size()) return points_;

  // Moving a corner by d between neighbors at a distance c changes the vector area by d x c / 2. So d = 2 c x a /
  // |c|^2, at right angles to c, compensates a lost area a. Each end of a chord compensates half of its loss.
  std::vector<Point> result;
  for (const std::size_t end : ends) result.push_back(points_[end]);
  const std::size_t chords = ends.size() - 1;
  for (std::size_t k = 1; k < chords; ++k) {
    const double before = k == 1 ? 1 : 0.5;
    const double after = k + 1 == chords ? 1 : 0.5;
    const Vector area = before * lost_area(ends[k - 1], ends[k]) + after * lost_area(ends[k], ends[k + 1]);
    const Vector across = result[k + 1] - result[k - 1];
    const Vector move = 2 * across.cross(area) / across.squaredNorm();
    if (!(move.norm() <= tolerance_)) return points_;
    result[k] += move;
  }
  return result;
}

std::vector<Point> reversed(std::vector<Point> points) {
  std::reverse(points.begin(), points.end());
  return points;
}

// The corners of an outline from one that is kept to the next, or all the way round where none is.
struct Stretch {
  std::vector<Point> points;  // both ends too
  double width;               // of the longest patch edge, or the narrowest face if that is less
  bool reversed;
};

std::vector<Point> coarse_stretch(const Stretch& stretch) {
  const double tolerance = outline_tolerance / 2 * stretch.width;
  return stretch.reversed ? reversed(Run(reversed(stretch.points), tolerance).coarse())
                          : Run(stretch.points, tolerance).coarse();
}

}  // namespace

std::vector<Point> outline_corners(const Scene& scene, PolygonIndex polygon) {
  std::vector<Point> corners;
  corners.reserve(scene.polygons[polygon].corners.size());
  for (const Point& corner : corner_points(scene, polygon)) {
    if (corners.empty() || corner != corners.back()) corners.push_back(corner);
  }
  while (corners.size() > 1 && corners.back() == corners.front()) corners.pop_back();
  return corners;
}

LooseCorners find_loose_corners(const Scene& scene) {
  std::vector<std::uint8_t> has_many(scene.polygons.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) has_many[p] = scene.polygons[p].corners.size() > 24;
  const std::vector<Occurrence> all = occurrences_in(scene, has_many);
  if (all.empty()) return {};
  const std::vector<std::uint8_t> met = met_by_others(scene, has_many, all);
  std::vector<double> widths(scene.polygons.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (has_many[p]) widths[p] = width_of(scene, p);
  }

  LooseCorners loose(scene.polygons.size());
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].at == all[begin].at) ++end;
    const std::span<const Occurrence> here = std::span(all).subspan(begin, end - begin);
    if (met[begin] || !is_on_one_run(here)) continue;
    const double width = std::min(widths[here.front().polygon], widths[here.back().polygon]);
    for (const Occurrence& corner : here) {
      auto& of_polygon = loose[corner.polygon];
      of_polygon.resize(scene.polygons[corner.polygon].corners.size());
      of_polygon[corner.corner] = {width, corner.before != here.front().before};
    }
  }
  return loose;
}

std::vector<Point> coarse_outline(const Scene& scene, const LooseCorners& loose, PolygonIndex polygon,
                                  double max_edge) {
  std::vector<Point> corners = outline_corners(scene, polygon);
  if (loose.empty() || loose[polygon].empty()) return corners;
  const std::size_t n = corners.size();
  const auto width = [&](std::size_t k) -> double {
    const double of_corner = loose[polygon][k].width;
    const double shortest = std::min(of_corner, max_edge);
    const bool is_fine = (corners[(k + 1) % n] - corners[k]).norm() < shortest &&
                         (corners[(k + n - 1) % n] - corners[k]).norm() < shortest;
    return is_fine ? of_corner : 0;
  };

  // From a corner that is kept, if any is, once around.
  std::size_t first = 0;
  while (first < n && width(first) > 0) ++first;
  first %= n;
  std::vector<Point> coarse;
  for (std::size_t k = 0; k < n;) {
    Stretch stretch{{corners[(first + k) % n]}, max_edge, loose[polygon][(first + k + 1) % n].reversed};
    for (++k; k < n && width((first + k) % n) > 0; ++k) {
      stretch.points.push_back(corners[(first + k) % n]);
      stretch.width = std::min(stretch.width, width((first + k) % n));
    }
    stretch.points.push_back(corners[(first + k) % n]);
    const std::vector<Point> points = coarse_stretch(stretch);
    coarse.insert(coarse.end(), points.begin(), points.end() - 1);
  }
  return coarse.size() == n || coarse.size() < 3 || crosses_itself(coarse) ? corners : coarse;
}

}  // namespace patchlight
