#include "mesh/lattice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

struct Segment {
  FlatPoint from, to;
};

// The polygon's edges that come nearer than `margin` to the line at y or cross it.
std::vector<Segment> edges_near(std::span<const FlatPoint> polygon, double y, double margin) {
  std::vector<Segment> edges;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const FlatPoint& from = polygon[k];
    const FlatPoint& to = polygon[(k + 1) % polygon.size()];
    if (std::min(from.y(), to.y()) <= y + margin && std::max(from.y(), to.y()) >= y - margin) {
      edges.push_back({from, to});
    }
  }
  return edges;
}

// Does a ray along x cross the edges an odd number of times, and is none of them near?
bool is_well_inside(const FlatPoint& point, std::span<const Segment> edges, double margin) {
  bool inside = false;
  for (const auto& [from, to] : edges) {
    const FlatPoint edge = to - from;
    const double t = std::clamp((point - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    if ((from + t * edge - point).squaredNorm() < margin * margin) return false;
    if ((from.y() > point.y()) == (to.y() > point.y())) continue;
    if (from.x() + (point.y() - from.y()) / edge.y() * edge.x() > point.x()) inside = !inside;
  }
  return inside;
}

}  // namespace

std::vector<std::vector<FlatPoint>> lattice_rows(std::span<const FlatPoint> polygon, double spacing, double margin) {
  Eigen::AlignedBox2d bounds;
  for (const FlatPoint& corner : polygon) bounds.extend(corner);
  const double height = std::sqrt(0.75) * spacing;
  std::vector<std::vector<FlatPoint>> rows;
  for (double row = std::ceil(bounds.min().y() / height); row * height < bounds.max().y(); ++row) {
    const double y = row * height;
    const double shift = std::fmod(row, 2) == 0 ? 0 : 0.5;  // every other row stands in the gaps of the last
    const std::vector<Segment> edges = edges_near(polygon, y, margin);
    std::vector<FlatPoint> points;
    for (double k = std::ceil(bounds.min().x() / spacing); (k + shift) * spacing < bounds.max().x(); ++k) {
      const FlatPoint point((k + shift) * spacing, y);
      if (is_well_inside(point, edges, margin)) points.push_back(point);
    }
    if (!points.empty()) rows.push_back(std::move(points));
  }
  return rows;
}

}  // namespace patchlight
