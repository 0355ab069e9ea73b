#include "visibility/flat_polygon.h"

#include "scene/face_tree.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

FlatPolygon flat_polygon(std::span<const Point> corners) {
  const Vector normal = area_vector(corners).normalized();
  const Vector u = normal.unitOrthogonal();
  FlatPolygon polygon{corners[0], u, normal.cross(u), normal, {}, {}};
  for (const Point& corner : corners) {
    polygon.corners.push_back(polygon.in_plane(corner));
    polygon.box.extend(polygon.corners.back());
  }
  return polygon;
}

namespace {

bool touches(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  if (!box.intersects(Eigen::AlignedBox2d(a.cwiseMin(b), a.cwiseMax(b)))) return false;
  // The box's corners on both sides of the line: its half width across the line reaches the middle's distance.
  const Eigen::Vector2d across(a.y() - b.y(), b.x() - a.x());
  return std::abs(across.dot(box.center() - a)) <= across.cwiseAbs().dot(box.sizes()) / 2;
}

// Even-odd rule: the seam of a hole is crossed twice.
bool is_inside(const FlatPolygon& polygon, const Eigen::Vector2d& point) {
  if (!polygon.box.contains(point)) return false;
  bool inside = false;
  for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
    const Eigen::Vector2d& a = polygon.corners[k];
    const Eigen::Vector2d& b = polygon.corners[(k + 1) % polygon.corners.size()];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

// Whether a rectangle lies in a polygon: no edge touches it, and its middle lies inside. A hole's seam counts as an
// edge.
bool holds(const FlatPolygon& polygon, const Eigen::AlignedBox2d& box) {
  for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
    if (touches(box, polygon.corners[k], polygon.corners[(k + 1) % polygon.corners.size()])) return false;
  }
  return is_inside(polygon, box.center());
}

}  // namespace

bool contains(const FlatPolygon& polygon, const Point& point) { return is_inside(polygon, polygon.in_plane(point)); }

// Whether a polygon cuts every segment from the hull of some points to that of others. With heights h > 0 of the points
// a and h' < 0 of the points b over its plane, segments from a to b cross it at (h b - h' a) / (h - h'): for points of
// the hulls that is a mean, with positive weights, of the crossings between their corners. So all crossings lie in the
// polygon when it holds a rectangle around those of the corners.
bool cuts_all(const FlatPolygon& polygon, std::span<const Point> from, std::span<const Point> to, double tolerance) {
  const double sign = polygon.height(from[0]) > 0 ? 1 : -1;
  Eigen::AlignedBox2d crossings;
  for (const Point& a : from) {
    const double above = sign * polygon.height(a);
    if (above <= tolerance) return false;
    for (const Point& b : to) {
      const double below = sign * polygon.height(b);
      if (below >= -tolerance) return false;
      crossings.extend(polygon.in_plane((above * b - below * a) / (above - below)));
    }
  }
  return holds(polygon, crossings);
}

std::vector<std::uint8_t> on_convex_hull(const Scene& scene) {
  const HalfSpaces occupied = occupied_half_spaces(scene);
  std::vector<std::uint8_t> result;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    result.push_back(!(occupied.before[p] && occupied.behind[p]));
  return result;
}

void CoveredPlaces::add(std::span<const Point> corners) {
  polygons.push_back(flat_polygon(corners));
  Eigen::AlignedBox3d box;
  for (const Point& corner : corners) box.extend(corner);
  // A place may lie before the plane by in_plane_tolerance, and single precision is coarser far from the center.
  const double farthest = std::max(1.0, std::max(box.max().maxCoeff(), -box.min().minCoeff()));
  const Vector margin = Vector::Constant(2 * in_plane_tolerance * farthest);
  boxes.emplace_back((box.min() - margin).cast<float>(), (box.max() + margin).cast<float>());
}

bool CoveredPlaces::covers(PolygonIndex polygon, Side side, const Point& place) const {
  const auto over = coverings.over_side(polygon, side);
  const Eigen::Vector3f nearby = place.cast<float>();
  return std::any_of(over.begin(), over.end(), [&](PolygonIndex other) {
    return boxes[other].contains(nearby) && contains(polygons[other], place);
  });
}

bool CoveredPlaces::lie_in_one_plane(PolygonIndex a, PolygonIndex b) const {
  if (a == no_polygon || b == no_polygon) return false;
  for (const Side side : {Side::front, Side::back})
    if (coverings.lies_over(a, b, side) || coverings.lies_over(b, a, side)) return true;
  return false;
}

bool CoveredPlaces::covers_end(const Point& from, const Point& to, PolygonIndex from_polygon,
                               PolygonIndex to_polygon) const {
  const auto covers_start = [&](const Point& start, const Point& end, PolygonIndex polygon) {
    if (polygon == no_polygon) return false;
    const double rise = polygons[polygon].normal.dot(end - start);
    // Along the surface neither side is seen.
    if (std::abs(rise) <= in_plane_tolerance) return false;
    return covers(polygon, rise > 0 ? Side::front : Side::back, start);
  };
  return covers_start(from, to, from_polygon) || covers_start(to, from, to_polygon);
}

}  // namespace patchlight
