#include "render/lightmap.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "mesh/patch_lookup.h"
#include "render/camera.h"
#include "visibility/occluder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>

namespace patchlight {
namespace {

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

Eigen::Vector2d in_texels(const LightmapChart& chart, const Point& point) {
  const Vector from = point - chart.corner;
  return {chart.right.dot(from) / chart.texel[0], chart.down.dot(from) / chart.texel[1]};
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
  const Eigen::Vector2d place = in_texels(from, one.point);
  const double x = place.x() - 0.5, y = place.y() - 0.5;
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
  const Vector above = 0.05 * map_.texel * normal;  // of sight lines along the surface, and rays down to it
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

// The map with the light of coplanar neighbors at the texels around each chart. Where another chart continues in its
// plane, and no wall stands between, both interpolate the same values at their common edge. Needs a map with padding.
Lightmap with_neighbours(Lightmap map, const SolvedLight& solved, const PatchLookup& lookup) {
  const std::size_t charts = map.charts.size();
  Neighbours neighbours(std::move(map), solved, lookup);
  parallel_for(charts, [&](std::size_t chart) { neighbours.lit_by_others(chart); });
  return std::move(neighbours).map();
}

constexpr int bake_block_edge = 16;  // texels that are baked at once

// Samples of a texel are the middles of its parts. Each four consecutive samples cover all rows and columns and
// surround the texel's middle.
constexpr int parts_per_edge = 4;
constexpr std::array<int, 16> columns_of_parts = {1, 3, 0, 2, 2, 0, 3, 1, 0, 2, 1, 3, 3, 1, 2, 0};
constexpr std::array<int, 16> rows_of_parts = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
constexpr std::size_t parts_of_texel = columns_of_parts.size();

// Some texels of a chart, and the patches that reach there.
struct BakeBlock {
  std::size_t chart = 0;
  int left = 0, top = 0;  // in the chart
  std::vector<PatchIndex> patches;
};

// A place of a texel that is on a surface.
struct BakePlace {
  std::size_t texel = 0;  // of the block, row by row
  std::uint32_t part = 0;
  PatchPoint at;
};

Eigen::AlignedBox2d box_in_texels(const LightmapChart& chart, const PatchCorners& corners) {
  Eigen::AlignedBox2d box;
  for (int k = 0; k < corners.count; ++k) box.extend(in_texels(chart, corners.points[static_cast<std::size_t>(k)]));
  return box;
}

std::vector<BakeBlock> blocks_of_chart(const LightmapChart& chart, std::size_t number, const PatchMesh& mesh) {
  const int columns = (chart.width + bake_block_edge - 1) / bake_block_edge;
  const int rows = (chart.height + bake_block_edge - 1) / bake_block_edge;
  std::vector<BakeBlock> blocks;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) blocks.push_back({number, x * bake_block_edge, y * bake_block_edge, {}});
  for (const PatchIndex patch : chart.patches) {
    const Eigen::AlignedBox2d box = box_in_texels(chart, mesh.corner_points(patch));
    const auto block_at = [](double place, int count) {
      return std::clamp(static_cast<int>(std::floor(place / bake_block_edge)), 0, count - 1);
    };
    for (int y = block_at(box.min().y(), rows); y <= block_at(box.max().y(), rows); ++y)
      for (int x = block_at(box.min().x(), columns); x <= block_at(box.max().x(), columns); ++x)
        blocks[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x)]
            .patches.push_back(patch);
  }
  std::erase_if(blocks, [](const BakeBlock& block) { return block.patches.empty(); });
  return blocks;
}

// Whether a point of a convex patch's plane is in it, or on its edge.
bool lies_in(const PatchCorners& corners, const Vector& normal, const Point& point) {
  for (int k = 0; k < corners.count; ++k) {
    const Point& a = corners.points[static_cast<std::size_t>(k)];
    const Point& b = corners.points[static_cast<std::size_t>((k + 1) % corners.count)];
    if (normal.dot((b - a).cross(point - a)) < 0) return false;
  }
  return true;
}

class Bake {
 public:
  Bake(const SolvedLight& solved, const FieldView& sent_besides, PackedCharts charts, const BakeOptions& options);

  Lightmap run(const Observer& observer) &&;

 private:
  std::vector<BakePlace> places_of(const BakeBlock& block) const;
  std::vector<PatchIndex> patches_at_parts(const BakeBlock& block) const;
  bool sees_backs(const BakePlace& place, std::span<const Vector> directions) const;
  bool is_buried(const BakePlace& place, std::uint32_t seed) const;
  Point place_on(const LightmapChart& chart, int x, int y, std::size_t part) const;
  Field direct_at(const BakeBlock& block, const std::vector<BakePlace>& places) const;
  void bake_block(const BakeBlock& block);
  std::size_t texel_of(const BakeBlock& block, std::size_t of_block) const;
  IrradianceRecord gathered(std::span<const BakePlace> places, std::size_t texel) const;
  std::uint32_t key_of(std::size_t texel) const { return hash({options_.seed, texel}); }

  const SolvedLight& solved_;
  const Field sent_besides_;
  const BakeOptions& options_;
  GatheredLight gather_;
  Lightmap map_;
  std::vector<BakeBlock> blocks_;
};

Bake::Bake(const SolvedLight& solved, const FieldView& sent_besides, PackedCharts charts, const BakeOptions& options)
    : solved_(solved), sent_besides_(sent_besides), options_(options), gather_(solved) {
  map_.width = charts.width;
  map_.height = charts.height;
  map_.texel = charts.texel;
  map_.charts = std::move(charts.charts);
  const Eigen::Index count = static_cast<Eigen::Index>(map_.width) * map_.height;
  map_.patch.assign(static_cast<std::size_t>(count), no_patch);
  for (TexelField* field : {&map_.direct, &map_.indirect, &map_.radiance})
    *field = TexelField::Zero(count, solved.exitance.cols());
  map_.error = Eigen::ArrayXf::Zero(count);
  for (std::size_t c = 0; c < map_.charts.size(); ++c) {
    for (BakeBlock& block : blocks_of_chart(map_.charts[c], c, solved.mesh)) blocks_.push_back(std::move(block));
  }
}

Point Bake::place_on(const LightmapChart& chart, int x, int y, std::size_t part) const {
  const double u = x + (columns_of_parts[part] + 0.5) / parts_per_edge;
  const double v = y + (rows_of_parts[part] + 0.5) / parts_per_edge;
  return chart.corner + u * chart.texel[0] * chart.right + v * chart.texel[1] * chart.down;
}

// Which patch is at each part of each texel of a block.
std::vector<PatchIndex> Bake::patches_at_parts(const BakeBlock& block) const {
  const LightmapChart& chart = map_.charts[block.chart];
  std::vector<PatchIndex> at(std::size_t{bake_block_edge} * bake_block_edge * parts_of_texel, no_patch);
  const auto range = [](double lower, double upper, int from, int size) {
    const int begin = std::max(0, static_cast<int>(std::floor(lower)) - from);
    return std::array<int, 2>{begin,
                              std::min({bake_block_edge, size - from, static_cast<int>(std::floor(upper)) + 1 - from})};
  };
  for (const PatchIndex patch : block.patches) {
    const PatchCorners corners = solved_.mesh.corner_points(patch);
    const Eigen::AlignedBox2d box = box_in_texels(chart, corners);
    const auto columns = range(box.min().x(), box.max().x(), block.left, chart.width);
    const auto rows = range(box.min().y(), box.max().y(), block.top, chart.height);
    for (int y = rows[0]; y < rows[1]; ++y) {
      for (int x = columns[0]; x < columns[1]; ++x) {
        for (std::size_t part = 0; part < parts_of_texel; ++part) {
          PatchIndex& there = at[static_cast<std::size_t>(y * bake_block_edge + x) * parts_of_texel + part];
          const Point point = place_on(chart, block.left + x, block.top + y, part);
          if (there == no_patch && lies_in(corners, solved_.mesh.normal[patch], point)) there = patch;
        }
      }
    }
  }
  return at;
}

// Whether three rays in four or more from a place, of so many, meet sides without patches.
bool Bake::sees_backs(const BakePlace& place, std::span<const Vector> directions) const {
  const std::size_t most_at_patches = directions.size() / 4;
  std::size_t at_patches = 0;
  for (const Vector& direction : directions) {
    const Ray ray{place.at.point, direction, solved_.mesh.polygon[place.at.patch]};
    const std::optional<Hit> hit = solved_.occluder.first_hits({&ray, 1})[0];
    if (!hit) return false;
    const PatchRange there = solved_.mesh.patches_on(hit->polygon, hit->side);
    if (there.begin != there.end && ++at_patches > most_at_patches) return false;
  }
  return true;
}

// Whether a place is inside of a solid that stands on its face, as a wall on a floor that runs on under it: nearly all
// rays from there meet its inner sides, the others perhaps faces that run on under it as well. Under a face that hangs
// close over the place those around the horizon get out.
bool Bake::is_buried(const BakePlace& place, std::uint32_t seed) const {
  const std::uint32_t rays_of_place = 8;
  const Vector& normal = solved_.mesh.normal[place.at.patch];
  std::vector<Vector> directions;
  for (std::uint32_t k = 0; k < rays_of_place; ++k) {
    const auto u = pixel_sample_2d(k, seed);
    directions.push_back(cosine_direction(normal, u[0], u[1]));
  }
  if (!sees_backs(place, directions)) return false;
  const Vector right = normal.unitOrthogonal();
  for (std::uint32_t k = 0; k < rays_of_place; ++k) {
    const double azimuth = 2 * std::numbers::pi * k / rays_of_place;
    directions[k] = (std::cos(azimuth) * right + std::sin(azimuth) * normal.cross(right) + 1e-3 * normal).normalized();
  }
  return sees_backs(place, directions);
}

// In the order of texels and parts, without those that are buried.
std::vector<BakePlace> Bake::places_of(const BakeBlock& block) const {
  const LightmapChart& chart = map_.charts[block.chart];
  const std::vector<PatchIndex> at = patches_at_parts(block);
  std::vector<BakePlace> places;
  std::vector<std::uint8_t> has_place(std::size_t{bake_block_edge} * bake_block_edge);
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (at[k] == no_patch) continue;
    const std::size_t texel = k / parts_of_texel, part = k % parts_of_texel;
    const int x = block.left + static_cast<int>(texel) % bake_block_edge;
    const int y = block.top + static_cast<int>(texel) / bake_block_edge;
    places.push_back({texel, static_cast<std::uint32_t>(part), {place_on(chart, x, y, part), at[k]}});
    has_place[texel] = 1;
  }
  // The middle of patches that lie between all parts
  for (const PatchIndex patch : block.patches) {
    const Eigen::Vector2d middle = in_texels(chart, solved_.mesh.centroid[patch]);
    const int x = std::clamp(static_cast<int>(std::floor(middle.x())), 0, chart.width - 1) - block.left;
    const int y = std::clamp(static_cast<int>(std::floor(middle.y())), 0, chart.height - 1) - block.top;
    if (std::min(x, y) < 0 || std::max(x, y) >= bake_block_edge) continue;
    const auto texel = static_cast<std::size_t>(y) * bake_block_edge + static_cast<std::size_t>(x);
    if (has_place[texel]) continue;
    has_place[texel] = 1;
    places.push_back({texel, 0, {solved_.mesh.centroid[patch], patch}});
  }
  std::erase_if(places, [&](const BakePlace& place) {
    return is_buried(place, hash({key_of(texel_of(block, place.texel)), stream::buried_texels, place.part}));
  });
  std::stable_sort(places.begin(), places.end(),
                   [](const BakePlace& a, const BakePlace& b) { return a.texel < b.texel; });
  return places;
}

std::size_t Bake::texel_of(const BakeBlock& block, std::size_t of_block) const {
  const LightmapChart& chart = map_.charts[block.chart];
  const int x = chart.left + block.left + static_cast<int>(of_block) % bake_block_edge;
  const int y = chart.top + block.top + static_cast<int>(of_block) / bake_block_edge;
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(map_.width) + static_cast<std::size_t>(x);
}

Field Bake::direct_at(const BakeBlock& block, const std::vector<BakePlace>& places) const {
  SkyAims aims;
  std::vector<LitPoint> points;
  for (const BakePlace& place : places) {
    const std::uint32_t seed = hash({key_of(texel_of(block, place.texel)), stream::lights_of_texel});
    points.push_back(gather_.lit_point(place.at, place.part, seed, aims));
  }
  return light_samples(solved_.lights, points, static_cast<std::uint32_t>(options_.rays_to_lights));
}

// The mean of the gathers at the first places of a texel.
IrradianceRecord Bake::gathered(std::span<const BakePlace> places, std::size_t texel) const {
  IrradianceRecord mean;
  mean.irradiance = Spectrum::Zero(solved_.exitance.cols());
  double variance = 0;
  const std::size_t count = std::min(places.size(), static_cast<std::size_t>(options_.gathers));
  for (std::size_t k = 0; k < count; ++k) {
    const IrradianceRecord one =
        gather_.record_at(places[k].at, hash({key_of(texel), stream::gathers_of_texel, k}), 1, 1, options_.hemisphere);
    mean.irradiance += one.irradiance / static_cast<double>(count);
    variance += one.uncertainty * one.uncertainty;
  }
  mean.uncertainty = std::sqrt(variance) / static_cast<double>(count);
  return mean;
}

void Bake::bake_block(const BakeBlock& block) {
  const std::vector<BakePlace> places = places_of(block);
  const Field direct = direct_at(block, places);
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    while (end < places.size() && places[end].texel == places[begin].texel) ++end;
    const std::size_t texel = texel_of(block, places[begin].texel);
    const IrradianceRecord record = gathered(std::span(places).subspan(begin, end - begin), texel);
    Spectrum straight = Spectrum::Zero(direct.cols()), radiance = straight;
    for (std::size_t k = begin; k < end; ++k) {
      const auto& [point, patch] = places[k].at;
      const Spectrum here = direct.row(static_cast<Eigen::Index>(k));
      straight += here;
      // L = (E + rho H + t H_behind) / pi
      radiance += (sent_besides_.row(patch) + reflectance_at(solved_, patch, point) * (here + record.irradiance)) /
                  std::numbers::pi;
    }
    const auto count = static_cast<double>(end - begin);
    const auto row = static_cast<Eigen::Index>(texel);
    map_.patch[texel] = places[begin].at.patch;
    map_.direct.row(row) = (straight / count).max(0).cast<float>();
    map_.indirect.row(row) = record.irradiance.max(0).cast<float>();
    map_.radiance.row(row) = (radiance / count).max(0).cast<float>();
    map_.error[row] = static_cast<float>(record.uncertainty);
  }
}

Lightmap Bake::run(const Observer& observer) && {
  parallel_for(blocks_.size(), Stage::render, observer, [&](std::size_t b) { bake_block(blocks_[b]); });
  return std::move(map_);
}

}  // namespace

Lightmap bake(const SolvedLight& solved, const FieldView& sent_besides, PackedCharts charts, const BakeOptions& options,
              const Observer& observer) {
  Lightmap map = Bake(solved, sent_besides, std::move(charts), options).run(observer);
  return with_neighbours(with_padding(std::move(map), lightmap_padding), solved, PatchLookup(solved.mesh));
}

}  // namespace patchlight
