#include "mesh/grid_lines.h"

#include <algorithm>
#include <array>
#include <boost/polygon/polygon.hpp>
#include <boost/polygon/segment_utils.hpp>
#include <cmath>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

namespace polygon = boost::polygon;
using GridPlace = polygon::point_data<int>;
using GridSegment = polygon::segment_data<int>;

constexpr double farthest = 5e8;  // so that the product of two differences fits into 64 bits

GridPlace place_of(const FlatPoint& point, double width) {
  return {static_cast<int>(std::lround(point.x() / width)), static_cast<int>(std::lround(point.y() / width))};
}

bool is_too_far(const FlatPoint& point, double width) { return !(point.cwiseAbs().maxCoeff() <= farthest * width); }

// The coordinates of its ends, that which comes first first.
std::array<int, 4> ends_of(const GridSegment& segment) {
  const std::array<int, 2> low{segment.low().x(), segment.low().y()};
  const std::array<int, 2> high{segment.high().x(), segment.high().y()};
  const auto& [first, last] = std::minmax(low, high);
  return {first[0], first[1], last[0], last[1]};
}

}  // namespace

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

}  // namespace patchlight
