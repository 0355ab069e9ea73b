#include "mesh/noded_lines.h"

#include "base/disjoint_sets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/polygon/polygon.hpp>
#include <boost/polygon/segment_utils.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <geos_c.h>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// The lines that come nearer than `margin` to the line at y or cross it.
std::vector<FlatLine> near_row(std::span<const FlatLine> lines, double y, double margin) {
  std::vector<FlatLine> near;
  for (const auto& [from, to] : lines) {
    if (std::min(from.y(), to.y()) <= y + margin && std::max(from.y(), to.y()) >= y - margin)
      near.push_back({from, to});
  }
  return near;
}

bool is_near(const FlatPoint& point, std::span<const FlatLine> lines, double margin) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const FlatLine& line) { return to_line(point, line).squaredNorm() < margin * margin; });
}

// A part of a line between two places of a grid.
struct PartOnGrid {
  FlatLine ends;
  std::size_t line = 0;  // which line it is a part of
};

namespace polygon = boost::polygon;
using GridPlace = polygon::point_data<int>;
using GridSegment = polygon::segment_data<int>;

GridPlace place_of(const FlatPoint& point, double width) {
  return {static_cast<int>(std::lround(point.x() / width)), static_cast<int>(std::lround(point.y() / width))};
}

// So that the product of two differences fits into 64 bits.
bool is_too_far(const FlatPoint& point, double width) { return !(point.cwiseAbs().maxCoeff() <= 5e8 * width); }

// The coordinates of its ends, that which comes first first.
std::array<int, 4> ends_of(const GridSegment& segment) {
  const std::array<int, 2> low{segment.low().x(), segment.low().y()};
  const std::array<int, 2> high{segment.high().x(), segment.high().y()};
  const auto& [first, last] = std::minmax(low, high);
  return {first[0], first[1], last[0], last[1]};
}

// The same lines with their ends on a square grid, cut wherever they meet there: those that are nearer than the width
// of the grid lie on each other (snap rounding; Hobby 1999), a part for each. In the order of their ends. Nothing
// where one reaches farther than 5e8 widths from the origin.
std::vector<PartOnGrid> lines_on_grid(std::span<const FlatLine> lines, double width) {
  std::vector<GridSegment> segments;
  std::vector<std::size_t> line_of;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const auto& [from, to] = lines[k];
    if (is_too_far(from, width) || is_too_far(to, width)) return {};
    const GridSegment segment(place_of(from, width), place_of(to, width));
    if (segment.low() == segment.high()) continue;
    segments.push_back(segment);
    line_of.push_back(k);
  }
  std::vector<std::pair<std::size_t, GridSegment>> cut;
  polygon::intersect_segments(cut, segments.begin(), segments.end());
  std::vector<std::pair<std::array<int, 4>, std::size_t>> ends;
  ends.reserve(cut.size());
  for (const auto& [segment, part] : cut) ends.emplace_back(ends_of(part), line_of[segment]);
  std::sort(ends.begin(), ends.end());
  std::vector<PartOnGrid> parts;
  parts.reserve(ends.size());
  for (const auto& [place, line] : ends)
    parts.push_back({{width * FlatPoint(place[0], place[1]), width * FlatPoint(place[2], place[3])}, line});
  return parts;
}

// A context of GEOS serves one thread.
class Geos {
 public:
  Geos() : context_(GEOS_init_r()) {}
  ~Geos() { GEOS_finish_r(context_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;
  operator GEOSContextHandle_t() const { return context_; }

 private:
  GEOSContextHandle_t context_;
};

struct DestroyShape {
  GEOSContextHandle_t context = nullptr;
  void operator()(GEOSGeometry* shape) const { GEOSGeom_destroy_r(context, shape); }
};
using FlatShape = std::unique_ptr<GEOSGeometry, DestroyShape>;

FlatShape shape_of(const Geos& geos, std::span<const FlatLine> lines) {
  std::vector<GEOSGeometry*> parts;
  for (const auto& [from, to] : lines) {
    const std::array<double, 4> ends{from.x(), from.y(), to.x(), to.y()};
    GEOSCoordSequence* sequence = GEOSCoordSeq_copyFromBuffer_r(geos, ends.data(), 2, 0, 0);
    GEOSGeometry* line = sequence == nullptr ? nullptr : GEOSGeom_createLineString_r(geos, sequence);
    if (line != nullptr) parts.push_back(line);
  }
  return {GEOSGeom_createCollection_r(geos, GEOS_MULTILINESTRING, parts.data(), static_cast<unsigned>(parts.size())),
          {geos}};
}

// The corners of one line string.
std::vector<FlatPoint> points_of(const Geos& geos, const GEOSGeometry* string) {
  const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(geos, string);
  unsigned count = 0;
  if (sequence == nullptr || GEOSCoordSeq_getSize_r(geos, sequence, &count) == 0) return {};
  std::vector<double> values(std::size_t{2} * count);
  if (GEOSCoordSeq_copyToBuffer_r(geos, sequence, values.data(), 0, 0) == 0) return {};
  std::vector<FlatPoint> points;
  for (std::size_t k = 0; k < count; ++k) points.emplace_back(values[2 * k], values[2 * k + 1]);
  return points;
}

using GridPoint = std::array<double, 2>;

GridPoint grid_key(const FlatPoint& point) { return {point.x(), point.y()}; }

bool has_order(const FlatPoint& a, const FlatPoint& b) { return grid_key(a) < grid_key(b); }

std::vector<FlatLine> in_order(std::vector<FlatLine> lines) {
  for (auto& [from, to] : lines) {
    if (has_order(to, from)) std::swap(from, to);
  }
  std::sort(lines.begin(), lines.end(), [](const FlatLine& a, const FlatLine& b) {
    return a[0] != b[0] ? has_order(a[0], b[0]) : has_order(a[1], b[1]);
  });
  return lines;
}

// The strings that a shape is made of.
std::vector<std::vector<FlatPoint>> strings_of(const Geos& geos, const GEOSGeometry* shape) {
  std::vector<std::vector<FlatPoint>> strings;
  for (int k = 0; shape != nullptr && k < GEOSGetNumGeometries_r(geos, shape); ++k) {
    std::vector<FlatPoint> points = points_of(geos, GEOSGetGeometryN_r(geos, shape, k));
    if (points.size() > 1) strings.push_back(std::move(points));
  }
  return strings;
}

std::vector<FlatLine> lines_of(std::span<const std::vector<FlatPoint>> strings) {
  std::vector<FlatLine> lines;
  for (const std::vector<FlatPoint>& points : strings) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      if (points[i] != points[i + 1]) lines.push_back({points[i], points[i + 1]});
    }
  }
  return in_order(std::move(lines));
}

// Without those that are, with all that hang together with them, smaller than that.
std::vector<std::vector<FlatPoint>> large_ones(std::vector<std::vector<FlatPoint>> strings, double least_size) {
  std::map<GridPoint, std::uint32_t> first_at;
  DisjointSets parts(strings.size());
  for (std::uint32_t k = 0; k < strings.size(); ++k) {
    for (const FlatPoint& end : {strings[k].front(), strings[k].back()})
      parts.join(k, first_at.try_emplace(grid_key(end), k).first->second);
  }
  std::vector<Eigen::AlignedBox2d> boxes(strings.size());
  for (std::uint32_t k = 0; k < strings.size(); ++k) {
    for (const FlatPoint& point : strings[k]) boxes[parts.root(k)].extend(point);
  }
  std::vector<std::vector<FlatPoint>> large;
  for (std::uint32_t k = 0; k < strings.size(); ++k) {
    if (boxes[parts.root(k)].diagonal().norm() >= least_size) large.push_back(std::move(strings[k]));
  }
  return large;
}

// Lines on a grid: their parts, each once, and which lines go through each place where parts end.
struct GridLines {
  std::vector<FlatLine> parts;
  std::map<GridPoint, std::vector<std::size_t>> through;
};

GridLines on_grid(std::span<const FlatLine> lines, double grid) {
  GridLines found;
  for (const auto& [ends, line] : lines_on_grid(lines, grid)) {
    if (found.parts.empty() || found.parts.back() != ends) found.parts.push_back(ends);
    for (const FlatPoint& end : ends) {
      std::vector<std::size_t>& here = found.through[grid_key(end)];
      if (std::find(here.begin(), here.end(), line) == here.end()) here.push_back(line);
    }
  }
  for (auto& [place, here] : found.through) std::sort(here.begin(), here.end());
  return found;
}

// The exact position of a grid point on the lines through it: the end of a line, or a crossing, if that is near. Lines
// that coincide up to rounding need no other cuts.
std::optional<FlatPoint> exact_place(std::span<const FlatLine> lines, const std::vector<std::size_t>& through,
                                     const FlatPoint& point, double near) {
  const FlatPoint* end = nullptr;
  for (const std::size_t k : through) {
    for (const FlatPoint& one : lines[k]) {
      const double nearest = end == nullptr ? near : (*end - point).norm();
      if ((one - point).norm() < nearest) end = &one;
    }
  }
  if (end != nullptr) return *end;
  // The crossing with the widest angle; its sine is above 0.01.
  double widest = 0.01;
  std::optional<FlatPoint> crossing;
  for (const std::size_t one : through) {
    const auto& [from, to] = lines[one];
    const FlatPoint along = to - from;
    for (const std::size_t other : through) {
      const FlatPoint across = lines[other][1] - lines[other][0];
      const double sine = wedge(along, across);
      const double relative = std::abs(sine) / (along.norm() * across.norm());
      if (relative <= widest) continue;
      widest = relative;
      crossing = from + wedge(lines[other][0] - from, across) / sine * along;
    }
  }
  // Those of narrow angles cross anywhere near.
  return crossing && (*crossing - point).norm() <= near ? crossing : std::nullopt;
}

// Parts of the lines with their ends on a grid where they belong. Two that meet where nothing is to be cut become one.
std::vector<FlatLine> off_grid(std::vector<FlatLine> parts, const GridLines& on, std::span<const FlatLine> lines,
                               double grid) {
  std::map<GridPoint, std::optional<FlatPoint>> places;
  std::map<GridPoint, int> meet;
  for (const FlatLine& part : parts) {
    for (const FlatPoint& end : part) {
      const auto [place, is_new] = places.try_emplace(grid_key(end));
      const auto through = on.through.find(grid_key(end));
      if (is_new && through != on.through.end()) place->second = exact_place(lines, through->second, end, 2 * grid);
      ++meet[grid_key(end)];
    }
  }
  // Where more than two meet it is not known which of them go on as one.
  for (const auto& [key, count] : meet) {
    if (count != 2 && !places[key]) places[key] = FlatPoint(key[0], key[1]);
  }
  std::map<GridPoint, std::size_t> open;  // places where a part waits for another one
  std::vector<std::uint8_t> is_gone(parts.size(), 0);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    for (std::size_t end = 0; end < 2; ++end) {
      const FlatPoint at = parts[k][end];
      if (places[grid_key(at)]) continue;
      const auto waiting = open.find(grid_key(at));
      if (waiting == open.end()) {
        open.emplace(grid_key(at), k);
        continue;
      }
      // The other part grows into this one, which may in turn wait elsewhere.
      const std::size_t other = waiting->second;
      open.erase(waiting);
      const FlatPoint far = parts[other][0] == at ? parts[other][1] : parts[other][0];
      const auto far_waits = open.find(grid_key(far));
      if (far_waits != open.end() && far_waits->second == other) far_waits->second = k;
      parts[k][end] = far;
      is_gone[other] = 1;
    }
  }
  std::vector<FlatLine> placed;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (is_gone[k]) continue;
    const auto at = [&](const FlatPoint& end) { return places[grid_key(end)].value_or(end); };
    const FlatLine part{at(parts[k][0]), at(parts[k][1])};
    if (part[0] != part[1]) placed.push_back(part);
  }
  return placed;
}

// Joined to strings where no third line meets two.
FlatShape joined(const Geos& geos, const FlatShape& lines) {
  return {lines ? GEOSLineMerge_r(geos, lines.get()) : nullptr, {geos}};
}

// The edges at a distance to the left of those of a string, negative to the right. They meet in miters, which reach no
// farther than twice the distance. Edges that would run backward, where the string bends within the distance, are left
// out.
std::vector<FlatLine> edges_beside(const std::vector<FlatPoint>& string, double distance) {
  const std::size_t n = string.size() - 1;
  const bool is_ring = string.front() == string.back();
  const auto along = [&](std::size_t edge) -> FlatPoint { return (string[edge + 1] - string[edge]).normalized(); };
  const auto left = [](const FlatPoint& direction) -> FlatPoint { return {-direction.y(), direction.x()}; };
  std::vector<FlatPoint> places;
  for (std::size_t k = 0; k <= n; ++k) {
    const bool is_end = (k == 0 || k == n) && !is_ring;
    const FlatPoint after = left(along(is_end ? std::min(k, n - 1) : k % n));
    const FlatPoint before = is_end ? after : left(along((k + n - 1) % n));
    const FlatPoint middle = before + after;
    const double length = std::max(middle.norm(), 1e-6);  // twice the cosine of half the bend
    places.push_back(string[k] + distance * std::min(2 / length, 2.0) / length * middle);
  }
  std::vector<FlatLine> edges;
  for (std::size_t k = 0; k < n; ++k)
    if ((places[k + 1] - places[k]).dot(along(k)) > 0) edges.push_back({places[k], places[k + 1]});
  return edges;
}

}  // namespace

FlatPoint to_line(const FlatPoint& point, const FlatLine& line) {
  const auto& [from, to] = line;
  const double t = std::clamp((point - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
  return from + t * (to - from) - point;
}

std::vector<FlatLine> edges_of(std::span<const FlatPoint> polygon) {
  std::vector<FlatLine> edges;
  for (std::size_t k = 0; k < polygon.size(); ++k) edges.push_back({polygon[k], polygon[(k + 1) % polygon.size()]});
  return edges;
}

bool is_inside(const FlatPoint& point, std::span<const FlatLine> edges) {
  bool inside = false;
  for (const auto& [from, to] : edges) {
    if ((from.y() > point.y()) == (to.y() > point.y())) continue;
    if (from.x() + (point.y() - from.y()) / (to.y() - from.y()) * (to.x() - from.x()) > point.x()) inside = !inside;
  }
  return inside;
}

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
    std::vector<FlatPoint> points;
    for (double k = std::ceil(bounds.min().x() / spacing); (k + shift) * spacing < bounds.max().x(); ++k) {
      const FlatPoint point((k + shift) * spacing, y);
      if (!is_near(point, edges, margin) && is_inside(point, edges) && !is_near(point, inner, margin))
        points.push_back(point);
    }
    if (!points.empty()) rows.push_back(std::move(points));
  }
  return rows;
}

std::vector<FlatLine> noded_lines(std::span<const FlatLine> lines, double grid) {
  const GridLines on = on_grid(lines, grid);
  return off_grid(on.parts, on, lines, grid);
}

std::vector<FlatLine> simplified_lines(std::span<const FlatLine> lines, double grid, double tolerance,
                                       double least_size) {
  const Geos geos;
  const GridLines on = on_grid(lines, grid);
  const FlatShape strings = joined(geos, shape_of(geos, on.parts));
  if (!strings) return {};
  const FlatShape simpler(GEOSTopologyPreserveSimplify_r(geos, strings.get(), tolerance), {geos});
  return off_grid(lines_of(large_ones(strings_of(geos, simpler.get()), least_size)), on, lines, grid);
}

std::vector<FlatLine> lines_beside(std::span<const FlatLine> lines, double grid, double distance) {
  const Geos geos;
  const FlatShape strings = joined(geos, shape_of(geos, lines));
  std::vector<FlatLine> beside;
  for (const std::vector<FlatPoint>& string : strings_of(geos, strings.get())) {
    for (const double offset : {distance, -distance}) {
      const std::vector<FlatLine> edges = edges_beside(string, offset);
      beside.insert(beside.end(), edges.begin(), edges.end());
    }
  }
  // Without the parts that lie nearer to another line, or to the same one farther on.
  std::vector<FlatLine> parts = noded_lines(beside, grid);
  std::erase_if(parts, [&](const FlatLine& part) {
    const FlatPoint middle = (part[0] + part[1]) / 2;
    return std::any_of(lines.begin(), lines.end(),
                       [&](const FlatLine& line) { return to_line(middle, line).norm() < distance - 2 * grid; });
  });
  return parts;
}

}  // namespace patchlight
