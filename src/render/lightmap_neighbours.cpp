#include "render/lightmap_neighbours.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Sight lines along a surface, and rays down to it, begin this share of a texel above it.
constexpr double lift_of_texels = 0.05;

// A texel beside a chart, and one of the chart beside it.
struct RimTexel {
  Eigen::Index texel = 0;
  Point point = Point::Zero();  // its middle
  Point inside = Point::Zero();
  PatchIndex patch = 0;  // there
};

Point middle_of_texel(const LightmapChart& chart, int x, int y) {
  return chart.corner + (x + 0.5) * chart.texel[0] * chart.right + (y + 0.5) * chart.texel[1] * chart.down;
}

class Neighbours {
 public:
  Neighbours(Lightmap map, const SolvedLight& solved, const PatchLookup& lookup);

  void lit_by_others(std::size_t chart);
  Lightmap map() && { return std::move(map_); }

 private:
  bool is_of(const LightmapChart& chart, int x, int y) const;
  Eigen::Index index_of(const LightmapChart& chart, int x, int y) const;
  std::optional<RimTexel> rim_texel(const LightmapChart& chart, int x, int y) const;
  std::vector<RimTexel> rim_of(const LightmapChart& chart) const;
  void take_light(const RimTexel& one, const LightmapChart& from);

  Lightmap map_;
  const SolvedLight& solved_;
  const PatchLookup& lookup_;
  std::vector<std::size_t> chart_of_;  // per patch; of a clear one that of none
};

Neighbours::Neighbours(Lightmap map, const SolvedLight& solved, const PatchLookup& lookup)
    : map_(std::move(map)), solved_(solved), lookup_(lookup), chart_of_(solved.mesh.size(), map_.charts.size()) {
  for (std::size_t c = 0; c < map_.charts.size(); ++c) {
    for (const PatchIndex patch : map_.charts[c].patches) chart_of_[patch] = c;
  }
}

Eigen::Index Neighbours::index_of(const LightmapChart& chart, int x, int y) const {
  return static_cast<Eigen::Index>(chart.top + y) * map_.width + chart.left + x;
}

// True for a texel, counted from the chart's first, that has a surface of the chart.
bool Neighbours::is_of(const LightmapChart& chart, int x, int y) const {
  if (x < 0 || y < 0 || x >= chart.width || y >= chart.height) return false;
  return map_.patch[static_cast<std::size_t>(index_of(chart, x, y))] != no_patch;
}

std::optional<RimTexel> Neighbours::rim_texel(const LightmapChart& chart, int x, int y) const {
  if (is_of(chart, x, y)) return std::nullopt;
  constexpr std::array<std::array<int, 2>, 8> around = {
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
  for (const auto& [dx, dy] : around) {
    if (!is_of(chart, x + dx, y + dy)) continue;
    return RimTexel{index_of(chart, x, y), middle_of_texel(chart, x, y), middle_of_texel(chart, x + dx, y + dy),
                    map_.patch[static_cast<std::size_t>(index_of(chart, x + dx, y + dy))]};
  }
  return std::nullopt;
}

std::vector<RimTexel> Neighbours::rim_of(const LightmapChart& chart) const {
  std::vector<RimTexel> rim;
  for (int y = -1; y <= chart.height; ++y) {
    for (int x = -1; x <= chart.width; ++x) {
      if (const auto one = rim_texel(chart, x, y)) rim.push_back(*one);
    }
  }
  return rim;
}

// Interpolated among the texels of a chart that have a surface.
void Neighbours::take_light(const RimTexel& one, const LightmapChart& from) {
  const double x = from.right.dot(one.point - from.corner) / from.texel[0] - 0.5;
  const double y = from.down.dot(one.point - from.corner) / from.texel[1] - 0.5;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  double total = 0;
  std::array<double, 4> weights{};
  for (int k = 0; k < 4; ++k) {
    const int column = left + k % 2, row = top + k / 2;
    if (!is_of(from, column, row)) continue;
    weights[static_cast<std::size_t>(k)] = (1 - std::abs(x - column)) * (1 - std::abs(y - row));
    total += weights[static_cast<std::size_t>(k)];
  }
  if (!(total > 0)) return;
  const auto mean_of = [&](const TexelField& light) {
    TexelField mean = TexelField::Zero(1, light.cols());
    for (int k = 0; k < 4; ++k) {
      const double weight = weights[static_cast<std::size_t>(k)];
      if (weight == 0) continue;
      mean += static_cast<float>(weight / total) * light.row(index_of(from, left + k % 2, top + k / 2));
    }
    return mean;
  };
  const TexelField direct = mean_of(map_.direct), indirect = mean_of(map_.indirect);
  // The radiance has a step where reflectances have one: L + rho dH / pi.
  const TexelField more = direct + indirect - map_.direct.row(one.texel) - map_.indirect.row(one.texel);
  const TexelField reflectance = solved_.reflectance.row(one.patch).cast<float>();
  map_.radiance.row(one.texel) = (map_.radiance.row(one.texel) + reflectance * more / std::numbers::pi_v<float>).max(0);
  map_.direct.row(one.texel) = direct;
  map_.indirect.row(one.texel) = indirect;
}

void Neighbours::lit_by_others(std::size_t chart) {
  const LightmapChart& own = map_.charts[chart];
  const Vector& normal = solved_.mesh.normal[own.patches.front()];
  const Vector above = lift_of_texels * map_.texel * normal;
  const std::vector<RimTexel> rim = rim_of(own);
  std::vector<Ray> down;
  std::vector<Segment> along;
  for (const RimTexel& one : rim) {
    down.push_back({one.point + above, -normal, no_polygon});
    along.push_back({one.inside + above, one.point + above, no_polygon, no_polygon});
  }
  const auto hits = solved_.occluder.first_hits(down);
  const auto blocked = solved_.occluder.occluded(along);
  for (std::size_t k = 0; k < rim.size(); ++k) {
    if (!hits[k] || blocked[k] || std::abs(hits[k]->distance - above.norm()) > 0.1 * above.norm()) continue;
    const auto patch = lookup_.patch_at(hits[k]->polygon, hits[k]->side, hits[k]->point);
    if (!patch || chart_of_[*patch] == chart || chart_of_[*patch] == map_.charts.size()) continue;
    if (solved_.mesh.normal[*patch].dot(normal) < 1 - 1e-6) continue;
    take_light(rim[k], map_.charts[chart_of_[*patch]]);
  }
}

}  // namespace

Lightmap with_neighbours(Lightmap map, const SolvedLight& solved, const PatchLookup& lookup) {
  const std::size_t charts = map.charts.size();
  Neighbours neighbours(std::move(map), solved, lookup);
  parallel_for(charts, [&](std::size_t chart) { neighbours.lit_by_others(chart); });
  return std::move(neighbours).map();
}

}  // namespace patchlight
