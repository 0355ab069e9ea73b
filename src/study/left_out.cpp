#include "study/left_out.h"

#include "base/sampling.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// Of the mean irradiance: less on a side that was left out does not count.
constexpr double least_light = 1e-3;
constexpr double most_deviation = 3;  // standard errors

// Front and back of every polygon take part, and emit as ever.
KeptSides all_sides(const Scene& scene, const KeptSides& kept) {
  KeptSides all;
  all.front.assign(scene.polygons.size(), 1);
  all.back = all.front;
  all.emit_from_back = kept.emit_from_back;
  return all;
}

// The largest triangle of the polygon.
PathReceiver receiver_on(const Scene& scene, PolygonIndex polygon, Side side) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  PathReceiver receiver{{}, polygon, side};
  double largest = 0;
  for (const auto& [a, b, c] : triangulate(corners)) {
    const double area = (corners[b] - corners[a]).cross(corners[c] - corners[a]).norm() / 2;
    if (area <= largest) continue;
    largest = area;
    receiver.corners = {corners[a], corners[b], corners[c], corners[c]};
  }
  return receiver;
}

// The areas of the sides that are left out, in proportion; front and back of each polygon in turn; 0 for the others.
std::vector<double> areas_left_out(const Scene& scene, const KeptSides& kept) {
  std::vector<double> areas;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const double area = area_vector(corner_points(scene, p)).norm();
    areas.push_back(kept.front[p] != 0 ? 0 : area);
    areas.push_back(kept.back[p] != 0 ? 0 : area);
  }
  return areas;
}

}  // namespace

std::vector<std::uint32_t> drawn_by_weight(std::span<const double> weights, std::size_t count, const Drawing& drawing) {
  std::vector<std::pair<double, std::uint32_t>> keys;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    const double u = (hash({drawing.seed, drawing.purpose, i}) + 0.5) * 0x1p-32;
    keys.emplace_back(-std::log(u) / weights[i], i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> drawn;
  for (std::size_t k = 0; k < std::min(count, keys.size()); ++k) drawn.push_back(keys[k].second);
  return drawn;
}

std::vector<LeftOutSide> trace_left_out(const Scene& scene, const KeptSides& kept, const Spectrum& mean,
                                        const VerifyOptions& options, bool follows_reflections,
                                        const Observer& observer) {
  if (options.left_out == 0) return {};
  std::vector<LeftOutSide> sides;
  std::vector<PathReceiver> receivers;
  for (const std::uint32_t k :
       drawn_by_weight(areas_left_out(scene, kept), options.left_out, {options.seed, 0x6c656674})) {
    const Side side = k % 2 == 0 ? Side::front : Side::back;
    sides.push_back({k / 2, side, {}, {}});
    receivers.push_back(receiver_on(scene, k / 2, side));
  }
  if (sides.empty()) return sides;
  const PathEstimate paths = trace_irradiance(
      scene, all_sides(scene, kept), receivers,
      {.paths = options.paths, .seed = options.seed, .follows_reflections = follows_reflections}, observer);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    LeftOutSide& side = sides[k];
    side.irradiance = paths.irradiance.row(static_cast<Eigen::Index>(k));
    side.standard_error = paths.standard_error.row(static_cast<Eigen::Index>(k));
    side.is_lit = (side.irradiance > (most_deviation * side.standard_error).max(least_light * mean)).any();
  }
  return sides;
}

}  // namespace patchlight
