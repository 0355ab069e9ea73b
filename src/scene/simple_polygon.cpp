#include "scene/simple_polygon.h"

#include "base/tolerances.h"
#include "scene/face_tree.h"
#include "scene/triangulate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace patchlight {
namespace {

double perimeter(std::span<const Point> polygon) {
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) sum += (polygon[(k + 1) % polygon.size()] - polygon[k]).norm();
  return sum;
}

// Two corners far from each other: the farthest from the first one, and the farthest from that.
std::array<Point, 2> far_apart(std::span<const Point> polygon) {
  const auto farthest_from = [&](const Point& point) {
    return *std::max_element(polygon.begin(), polygon.end(), [&](const Point& a, const Point& b) {
      return (a - point).squaredNorm() < (b - point).squaredNorm();
    });
  };
  const Point one = farthest_from(polygon[0]);
  return {one, farthest_from(one)};
}

// Where two edges cross, the edges being those that begin at corners first < second.
struct Crossing {
  std::size_t first, second;
  Point point;
};

// Per edge the box around it, seen along the normal and made larger by `margin`.
std::vector<Box> boxes_of_edges(std::span<const Point> polygon, const Vector& normal, double margin) {
  const Vector across = normal.unitOrthogonal();
  const Vector along = normal.cross(across);
  const auto seen = [&](const Point& point) {
    const Vector from_first = point - polygon[0];
    return Point(across.dot(from_first), along.dot(from_first), 0);
  };
  std::vector<Box> boxes;
  boxes.reserve(polygon.size());
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Box box = Box(seen(polygon[k])).extend(seen(polygon[(k + 1) % polygon.size()]));
    boxes.push_back(with_margin(box, margin));
  }
  return boxes;
}

// The first edge, in their order, that crosses another, and the first one after it that it crosses.
std::optional<Crossing> find_crossing(std::span<const Point> polygon) {
  const Vector normal = plane_normal(polygon);
  if (normal.isZero(0)) return std::nullopt;
  const std::size_t n = polygon.size();
  const double length = perimeter(polygon);
  const double rounding = tolerance_of_arithmetic * length * length;
  const auto opposite = [rounding](double x, double y) {
    return (x > rounding && y < -rounding) || (x < -rounding && y > rounding);
  };
  const auto point = [&](std::size_t k) -> const Point& { return polygon[k % n]; };
  const auto cross = [&](std::size_t i, std::size_t j) {
    const bool neighbours = i == 0 && j + 1 == n;
    const Point& a = point(i);
    const Point& b = point(i + 1);
    const Point& c = point(j);
    const Point& d = point(j + 1);
    return !neighbours && opposite(turn(normal, a, b, c), turn(normal, a, b, d)) &&
           opposite(turn(normal, c, d, a), turn(normal, c, d, b));
  };
  const std::vector<Box> boxes = boxes_of_edges(polygon, normal, tolerance_of_shapes * length);
  const BoxRow edges(boxes);
  for (std::size_t i = 0; i + 2 < n; ++i) {
    const auto is_apart = [&](const Box& box) { return !box.intersects(boxes[i]); };
    const std::optional<std::size_t> j = edges.first(i + 2, is_apart, [&](std::size_t k) { return cross(i, k); });
    if (!j) continue;
    const double side_c = turn(normal, point(i), point(i + 1), point(*j));
    const double side_d = turn(normal, point(i), point(i + 1), point(*j + 1));
    return Crossing{i, *j, point(*j) + side_c / (side_c - side_d) * (point(*j + 1) - point(*j))};
  }
  return std::nullopt;
}

// True when an edge of the first of two convex outlines that run around `normal` has all of the second on its outer
// side, up to `width`.
bool separates(std::span<const Point> outline, std::span<const Point> other, const Vector& normal, double width) {
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& corner = outline[k];
    const Vector edge = outline[(k + 1) % outline.size()] - corner;
    if (!(edge.norm() > width)) continue;
    const Vector inward = normal.cross(edge).normalized();
    if (std::all_of(other.begin(), other.end(), [&](const Point& p) { return inward.dot(p - corner) <= width; }))
      return true;
  }
  return false;
}

// The polygon with other corners.
Polygon with_corners(Polygon polygon, std::vector<std::uint32_t> corners) {
  polygon.corners = std::move(corners);
  return polygon;
}

// Those triangles of a polygon that are not narrow.
std::vector<Polygon> in_triangles(const Polygon& polygon, const std::vector<Point>& points,
                                  const std::vector<std::array<std::uint32_t, 3>>& triangles, double width) {
  std::vector<Polygon> pieces;
  for (const auto& [a, b, c] : triangles) {
    if (is_narrow(std::array{points[a], points[b], points[c]}, width)) continue;
    pieces.push_back(with_corners(polygon, {polygon.corners[a], polygon.corners[b], polygon.corners[c]}));
  }
  return pieces;
}

// The two triangles of a bent quadrilateral: of both diagonals the one over which it is bent less.
std::vector<std::array<std::uint32_t, 3>> folded(const std::vector<Point>& points) {
  const auto cosine = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {  // over the diagonal a c
    const Vector one = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
    return one.dot((points[c] - points[a]).cross(points[d] - points[a]).normalized());
  };
  if (cosine(0, 1, 2, 3) >= cosine(1, 2, 3, 0)) return {{0, 1, 2}, {0, 2, 3}};
  return {{1, 2, 3}, {1, 3, 0}};
}

// A polygon that does not cross itself: whole when it is planar, else in triangles.
Pieces simple_pieces(const Polygon& polygon, const std::vector<Point>& points, double width) {
  if (polygon.corners.size() == 3) return {{polygon}, {}, {}};
  const bool planar = is_planar(points);
  if (!planar && points.size() == 4)
    return {in_triangles(polygon, points, folded(points), width), {}, DiagnosticCode::non_planar};
  const auto triangles = proper_triangles(points);
  if (!triangles) return {{}, {}, DiagnosticCode::self_intersecting};
  if (planar) return {{polygon}, {}, {}};
  return {in_triangles(polygon, points, *triangles, width), {}, DiagnosticCode::non_planar};
}

// A polygon that crosses itself, cut at the crossings.
Pieces cut_pieces(const Scene& scene, const Polygon& polygon, const std::vector<Point>& points, double width) {
  Pieces cut{{}, {}, DiagnosticCode::self_intersecting};
  for (const std::vector<Point>& loop : cut_at_crossings(points, width)) {
    std::vector<std::uint32_t> corners;
    for (const Point& point : loop) {
      corners.push_back(static_cast<std::uint32_t>(scene.vertices.size() + cut.new_vertices.size()));
      cut.new_vertices.push_back(point);
    }
    Polygon piece = with_corners(polygon, corners);
    for (Polygon& simple : simple_pieces(piece, loop, width).polygons) cut.polygons.push_back(std::move(simple));
  }
  return cut;
}

}  // namespace

Vector plane_normal(std::span<const Point> polygon) {
  const Vector area = area_vector(polygon);
  const double length = perimeter(polygon);
  // A smaller vector area does not define the plane.
  if (area.norm() > 1e-6 * length * length) return area.normalized();
  Point mean = Point::Zero();
  for (const Point& corner : polygon) mean += corner / static_cast<double>(polygon.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Point& corner : polygon) spread += (corner - mean) * (corner - mean).transpose();
  const double size = spread.trace();
  if (!(size > 0)) return Vector::Zero();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread / size);
  // The sign of an eigenvector is arbitrary; the vector area of a strip is small, but decides its front.
  const Vector normal = axes.eigenvectors().col(0);
  return normal.dot(area) < 0 ? Vector(-normal) : normal;
}

bool is_narrow(std::span<const Point> polygon, double width) {
  const std::array<Point, 2> ends = far_apart(polygon);
  const Point& from = ends[0];
  const Vector along = (ends[1] - from).normalized();
  return std::all_of(polygon.begin(), polygon.end(),
                     [&](const Point& corner) { return (corner - from).cross(along).norm() <= width; });
}

bool is_planar(std::span<const Point> polygon) {
  if (polygon.size() == 3) return true;
  const Vector normal = plane_normal(polygon);
  const double tolerance = 1e-5 * perimeter(polygon);  // a tenth of the one of check()
  return std::all_of(polygon.begin(), polygon.end(),
                     [&](const Point& corner) { return std::abs(normal.dot(corner - polygon[0])) <= tolerance; });
}

bool crosses_itself(std::span<const Point> polygon) { return polygon.size() > 3 && find_crossing(polygon).has_value(); }

std::vector<std::vector<Point>> cut_at_crossings(std::vector<Point> polygon, double width) {
  std::vector<std::vector<Point>> simple;
  std::vector<std::vector<Point>> left = {std::move(polygon)};
  for (std::size_t cuts = 0; !left.empty();) {
    const std::vector<Point> loop = std::move(left.back());
    left.pop_back();
    if (loop.size() < 3 || is_narrow(loop, width)) continue;
    const std::optional<Crossing> crossing = find_crossing(loop);
    if (!crossing) {
      simple.push_back(loop);
      continue;
    }
    if (++cuts > 100) return {};
    // From the crossing along the outline back to it: once the corners between the two edges, once all others.
    const auto begin = loop.begin();
    const auto first = static_cast<std::ptrdiff_t>(crossing->first) + 1;
    const auto second = static_cast<std::ptrdiff_t>(crossing->second) + 1;
    std::vector<Point> inner = {crossing->point};
    inner.insert(inner.end(), begin + first, begin + second);
    std::vector<Point> outer = {crossing->point};
    outer.insert(outer.end(), begin + second, loop.end());
    outer.insert(outer.end(), begin, begin + first);
    left.push_back(std::move(outer));
    left.push_back(std::move(inner));
  }
  const auto largest = std::max_element(simple.begin(), simple.end(), [](const auto& a, const auto& b) {
    return area_vector(a).squaredNorm() < area_vector(b).squaredNorm();
  });
  if (largest == simple.end()) return simple;
  const Vector front = area_vector(*largest);
  for (std::vector<Point>& loop : simple) {
    if (area_vector(loop).dot(front) < 0) std::reverse(loop.begin(), loop.end());
  }
  return simple;
}

std::vector<std::vector<Point>> beside(const std::vector<std::vector<Point>>& pieces,
                                       const std::array<Point, 3>& triangle, double width) {
  const Vector normal = area_vector(triangle).normalized();
  // Cut along the sides of the triangle one after the other.
  std::vector<std::vector<Point>> left;
  for (std::vector<Point> piece : pieces) {
    const Vector around = area_vector(piece).dot(normal) < 0 ? Vector(-normal) : normal;
    // Cutting a piece beside the triangle would only break it up.
    if (separates(triangle, piece, normal, width) || separates(piece, triangle, around, width)) {
      left.push_back(std::move(piece));
      continue;
    }
    for (std::size_t k = 0; k < 3 && piece.size() > 2; ++k) {
      const Vector inward = normal.cross(triangle[(k + 1) % 3] - triangle[k]).normalized();
      std::vector<Point> outside = clip_to_half_space(piece, triangle[k], -inward);
      if (outside.size() > 2 && !is_narrow(outside, width)) left.push_back(std::move(outside));
      piece = clip_to_half_space(piece, triangle[k], inward);
    }
  }
  return left;
}

std::optional<std::vector<std::array<std::uint32_t, 3>>> proper_triangles(std::span<const Point> polygon) {
  const Vector normal = plane_normal(polygon);
  const double rounding = tolerance_of_arithmetic * perimeter(polygon) * perimeter(polygon);
  std::vector<std::array<std::uint32_t, 3>> triangles = triangulate(polygon);
  for (const auto& [a, b, c] : triangles) {
    if (turn(normal, polygon[a], polygon[b], polygon[c]) < -rounding) return std::nullopt;
  }
  return triangles;
}

Pieces pieces_of(const Scene& scene, const Polygon& polygon, double width) {
  const std::vector<Point> points = corner_points(scene, polygon.corners);
  if (points.size() < 3 || is_narrow(points, width)) return {{}, {}, DiagnosticCode::zero_area};
  const bool is_bent_quadrilateral = points.size() == 4 && !is_planar(points);
  if (!is_bent_quadrilateral && crosses_itself(points)) return cut_pieces(scene, polygon, points, width);
  return simple_pieces(polygon, points, width);
}

}  // namespace patchlight
