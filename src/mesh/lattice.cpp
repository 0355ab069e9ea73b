#include "mesh/lattice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// Of these, what comes nearer than `margin` to the line at y or crosses it.
std::vector<FlatLine> near_row(std::span<const FlatLine> lines, double y, double margin) {
  std::vector<FlatLine> near;
  for (const auto& [from, to] : lines) {
    if (std::min(from.y(), to.y()) <= y + margin && std::max(from.y(), to.y()) >= y - margin)
      near.push_back({from, to});
  }
  return near;
}

std::vector<FlatLine> edges_of(std::span<const FlatPoint> polygon) {
  std::vector<FlatLine> edges;
  for (std::size_t k = 0; k < polygon.size(); ++k) edges.push_back({polygon[k], polygon[(k + 1) % polygon.size()]});
  return edges;
}

bool is_near(const FlatPoint& point, const FlatLine& line, double margin) {
  const auto& [from, to] = line;
  const FlatPoint edge = to - from;
  const double t = std::clamp((point - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (from + t * edge - point).squaredNorm() < margin * margin;
}

// Does a ray along x cross the edges an odd number of times, and is none of them near?
bool is_well_inside(const FlatPoint& point, std::span<const FlatLine> edges, double margin) {
  bool inside = false;
  for (const FlatLine& line : edges) {
    if (is_near(point, line, margin)) return false;
    const auto& [from, to] = line;
    const FlatPoint edge = to - from;
    if ((from.y() > point.y()) == (to.y() > point.y())) continue;
    if (from.x() + (point.y() - from.y()) / edge.y() * edge.x() > point.x()) inside = !inside;
  }
  return inside;
}

}  // namespace

std::vector<std::vector<FlatPoint>> lattice_rows(std::span<const FlatPoint> polygon, std::span<const FlatLine> lines,
                                                 double spacing, double margin) {
  const std::vector<FlatLine> outline = edges_of(polygon);
  Eigen::AlignedBox2d bounds;
  for (const FlatPoint& corner : polygon) bounds.extend(corner);
  const double height = std::sqrt(0.75) * spacing;
  std::vector<std::vector<FlatPoint>> rows;
  for (double row = std::ceil(bounds.min().y() / height); row * height < bounds.max().y(); ++row) {
    const double y = row * height;
    const double shift = std::fmod(row, 2) == 0 ? 0 : 0.5;  // every other row stands in the gaps of the last
    const std::vector<FlatLine> edges = near_row(outline, y, margin);
    const std::vector<FlatLine> inner = near_row(lines, y, margin);
    const auto is_clear = [&](const FlatPoint& point) {
      return std::none_of(inner.begin(), inner.end(), [&](const auto& line) { return is_near(point, line, margin); });
    };
    std::vector<FlatPoint> points;
    for (double k = std::ceil(bounds.min().x() / spacing); (k + shift) * spacing < bounds.max().x(); ++k) {
      const FlatPoint point((k + shift) * spacing, y);
      if (is_well_inside(point, edges, margin) && is_clear(point)) points.push_back(point);
    }
    if (!points.empty()) rows.push_back(std::move(points));
  }
  return rows;
}

}  // namespace patchlight
