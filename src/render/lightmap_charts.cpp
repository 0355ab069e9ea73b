#include "patchlight/base/error.h"
#include "patchlight/mesh/patch_mesh.h"

#include "base/disjoint_sets.h"
#include "base/tolerances.h"
#include "render/lightmap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// A side of a polygon with patches.
struct ChartFace {
  PolygonIndex polygon = 0;
  PatchRange patches;
  Vector normal;
  MaterialIndex material = 0;
};

std::vector<ChartFace> chart_faces(const Scene& scene, const PatchMesh& mesh) {
  std::vector<ChartFace> faces;
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    if (is_opening(scene, polygon)) continue;
    for (const Side side : {Side::front, Side::back}) {
      const PatchRange patches = mesh.patches_on(polygon, side);
      if (patches.begin == patches.end) continue;
      faces.push_back({polygon, patches, mesh.normal[patches.begin], mesh.material[patches.begin]});
    }
  }
  return faces;
}

// Two ends, the lower number first, and the faces that have the edge.
using Edge = std::array<std::uint32_t, 2>;
using FacesAtEdges = std::map<Edge, std::vector<std::size_t>>;

struct EdgesOfFaces {
  FacesAtEdges faces;
  std::vector<Point> points;  // that the ends are numbers of: vertices at one place are one
};

EdgesOfFaces edges_of(const Scene& scene, const std::vector<ChartFace>& faces) {
  EdgesOfFaces edges;
  std::map<std::array<double, 3>, std::uint32_t> numbers;
  const auto number_of = [&](std::uint32_t vertex) {
    const Point& point = scene.vertices[vertex];
    const auto next = static_cast<std::uint32_t>(edges.points.size());
    const auto [place, is_new] = numbers.try_emplace({point.x(), point.y(), point.z()}, next);
    if (is_new) edges.points.push_back(point);
    return place->second;
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::vector<std::uint32_t>& corners = scene.polygons[faces[f].polygon].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t a = number_of(corners[k]);
      const std::uint32_t b = number_of(corners[(k + 1) % corners.size()]);
      edges.faces[{std::min(a, b), std::max(a, b)}].push_back(f);
    }
  }
  return edges;
}

// The chart of each face: numbers from 0 in the order of their first faces.
std::vector<std::size_t> chart_numbers(const std::vector<ChartFace>& faces, const FacesAtEdges& edges) {
  DisjointSets charts(faces.size());
  for (const auto& [edge, around] : edges) {
    for (std::size_t k = 0; k < around.size(); ++k) {
      for (std::size_t l = k + 1; l < around.size(); ++l) {
        const ChartFace &a = faces[around[k]], &b = faces[around[l]];
        // Joined faces may differ by more.
        if (a.material != b.material || (a.normal - b.normal).norm() > 1e-4) continue;
        charts.join(static_cast<std::uint32_t>(around[k]), static_cast<std::uint32_t>(around[l]));
      }
    }
  }
  std::vector<std::size_t> numbers(faces.size());
  std::size_t count = 0;
  for (std::uint32_t f = 0; f < faces.size(); ++f) numbers[f] = charts.root(f) == f ? count++ : numbers[charts.root(f)];
  return numbers;
}

// The longest edge of each chart at which one face of it alone lies.
std::vector<Vector> longest_outer_edges(const EdgesOfFaces& edges, const std::vector<std::size_t>& charts,
                                        std::size_t count) {
  std::vector<Vector> longest(count, Vector::Zero());
  for (const auto& [edge, around] : edges.faces) {
    const Vector along = edges.points[edge[1]] - edges.points[edge[0]];
    for (const std::size_t face : around) {
      const auto is_of_chart = [&](std::size_t other) { return charts[other] == charts[face]; };
      if (std::count_if(around.begin(), around.end(), is_of_chart) > 1) continue;
      if (along.squaredNorm() > longest[charts[face]].squaredNorm()) longest[charts[face]] = along;
    }
  }
  return longest;
}

// Lower and upper ends of a chart along its axes, meters from its corner.
Eigen::AlignedBox2d extent_in_plane(const LightmapChart& chart, const PatchMesh& mesh) {
  Eigen::AlignedBox2d extent;
  for (const PatchIndex patch : chart.patches) {
    const PatchCorners corners = mesh.corner_points(patch);
    for (int k = 0; k < corners.count; ++k) {
      const Vector from = corners.points[static_cast<std::size_t>(k)] - chart.corner;
      extent.extend(Eigen::Vector2d(chart.right.dot(from), chart.down.dot(from)));
    }
  }
  return extent;
}

LightmapChart with_axes(LightmapChart chart, const PatchMesh& mesh, const Vector& along) {
  const Vector& normal = mesh.normal[chart.patches.front()];
  const Vector in_plane = along - normal * normal.dot(along);
  chart.right = in_plane.norm() > 0 ? Vector(in_plane.normalized()) : Vector(normal.unitOrthogonal());
  chart.down = chart.right.cross(normal);  // seen from the front, the map is not mirrored
  chart.corner = mesh.centroid[chart.patches.front()];
  const Eigen::AlignedBox2d extent = extent_in_plane(chart, mesh);
  chart.corner += extent.min().x() * chart.right + extent.min().y() * chart.down;
  chart.extent = {extent.sizes().x(), extent.sizes().y()};
  return chart;
}

// The number of texels, as long or shorter, that a length is cut into. A length that is longer by rounding needs no
// texel more.
double texels_over(double length, double texel) {
  return std::max(1.0, std::ceil(length / texel - tolerance_of_coordinates));
}

// Charts in rows from the left, the highest first. Nothing when they do not fit into a square.
std::optional<PackedCharts> packed_into(std::vector<LightmapChart> charts, int edge, double texel) {
  PackedCharts packed{{}, edge, 0, texel};
  for (LightmapChart& chart : charts) {
    const double width = texels_over(chart.extent[0], texel), height = texels_over(chart.extent[1], texel);
    if (std::max(width, height) + 2 * lightmap_padding > edge) return std::nullopt;
    chart.width = static_cast<int>(width);
    chart.height = static_cast<int>(height);
    chart.texel = {chart.extent[0] / width, chart.extent[1] / height};
  }
  std::vector<std::size_t> order(charts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return charts[a].height > charts[b].height; });
  int left = 0, top = 0, bottom = 0;
  for (const std::size_t k : order) {
    LightmapChart& chart = charts[k];
    if (left + chart.width + 2 * lightmap_padding > edge) {
      left = 0;
      top = bottom;
    }
    chart.left = left + lightmap_padding;
    chart.top = top + lightmap_padding;
    left += chart.width + 2 * lightmap_padding;
    bottom = std::max(bottom, top + chart.height + 2 * lightmap_padding);
    if (bottom > edge) return std::nullopt;
  }
  packed.height = 1;
  while (packed.height < bottom) packed.height *= 2;
  packed.charts = std::move(charts);
  return packed;
}

// With the smallest texels for which they fit, up to a part in a thousand; nothing when they fit with none.
std::optional<PackedCharts> fitted_into(const std::vector<LightmapChart>& charts, int edge) {
  double longest = 0;
  for (const LightmapChart& chart : charts) longest = std::max({longest, chart.extent[0], chart.extent[1]});
  std::optional<PackedCharts> best = packed_into(charts, edge, longest);
  if (!best) return best;
  // The longest chart alone needs so much.
  double too_small = longest / edge;
  while (best->texel / too_small > 1.001) {
    const double between = std::sqrt(best->texel * too_small);
    if (auto packed = packed_into(charts, edge, between))
      best = std::move(packed);
    else
      too_small = between;
  }
  return best;
}

[[noreturn]] void refuse_so_many(std::size_t charts) {
  throw InputError("lightmap.folder", "found " + std::to_string(charts) +
                                          " groups of coplanar faces; expected fewer, as a map of " +
                                          std::to_string(most_lightmap_edge) + " x " +
                                          std::to_string(most_lightmap_edge) + " texels cannot hold a chart for each");
}

using Step = std::array<int, 2>;
constexpr std::array<Step, 4> straight_steps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
constexpr std::array<Step, 4> diagonal_steps = {{{1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

// Light that a texel goes on with: a row each of direct, indirect and radiance.
struct PaddingTexel {
  Eigen::Index texel = 0;
  std::array<TexelField, 3> light;
};

class Padding {
 public:
  explicit Padding(Lightmap map) : map_(std::move(map)) {
    for (const PatchIndex patch : map_.patch) known_.push_back(patch != no_patch);
  }

  void grow(bool linearly);
  Lightmap map() && { return std::move(map_); }

 private:
  std::optional<Eigen::Index> known(int x, int y) const;
  std::optional<PaddingTexel> light_at(int x, int y, const std::array<Step, 4>& steps, bool linearly) const;

  Lightmap map_;
  std::vector<std::uint8_t> known_;  // per texel
};

std::optional<Eigen::Index> Padding::known(int x, int y) const {
  if (x < 0 || y < 0 || x >= map_.width || y >= map_.height) return std::nullopt;
  const Eigen::Index texel = static_cast<Eigen::Index>(y) * map_.width + x;
  if (!known_[static_cast<std::size_t>(texel)]) return std::nullopt;
  return texel;
}

// The mean of the light that the texels in some directions go on with; nothing when none of them is known.
std::optional<PaddingTexel> Padding::light_at(int x, int y, const std::array<Step, 4>& steps, bool linearly) const {
  const std::array<const TexelField*, 3> fields = {&map_.direct, &map_.indirect, &map_.radiance};
  PaddingTexel found{static_cast<Eigen::Index>(y) * map_.width + x, {}};
  for (TexelField& light : found.light) light = TexelField::Zero(1, map_.direct.cols());
  float count = 0;
  for (const auto& [dx, dy] : steps) {
    const auto near = known(x + dx, y + dy);
    if (!near) continue;
    const auto far = linearly ? known(x + 2 * dx, y + 2 * dy) : std::nullopt;
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const auto here = fields[f]->row(*near);
      if (far)
        found.light[f] += (2 * here - fields[f]->row(*far)).max(0).min(2 * here);
      else
        found.light[f] += here;
    }
    ++count;
  }
  if (count == 0) return std::nullopt;
  for (TexelField& light : found.light) light /= count;
  return found;
}

void Padding::grow(bool linearly) {
  std::vector<PaddingTexel> ring;
  for (int y = 0; y < map_.height; ++y) {
    for (int x = 0; x < map_.width; ++x) {
      if (known(x, y)) continue;
      auto found = light_at(x, y, straight_steps, linearly);
      if (!found) found = light_at(x, y, diagonal_steps, linearly);
      if (found) ring.push_back(*std::move(found));
    }
  }
  for (const auto& [texel, light] : ring) {
    map_.direct.row(texel) = light[0];
    map_.indirect.row(texel) = light[1];
    map_.radiance.row(texel) = light[2];
    known_[static_cast<std::size_t>(texel)] = 1;
  }
}

}  // namespace

std::vector<LightmapChart> charts_of(const Scene& scene, const PatchMesh& mesh) {
  const std::vector<ChartFace> faces = chart_faces(scene, mesh);
  const EdgesOfFaces edges = edges_of(scene, faces);
  const std::vector<std::size_t> numbers = chart_numbers(faces, edges.faces);
  std::vector<LightmapChart> charts(numbers.empty() ? 0 : *std::max_element(numbers.begin(), numbers.end()) + 1);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (PatchIndex patch = faces[f].patches.begin; patch < faces[f].patches.end; ++patch)
      charts[numbers[f]].patches.push_back(patch);
  }
  const std::vector<Vector> along = longest_outer_edges(edges, numbers, charts.size());
  for (std::size_t c = 0; c < charts.size(); ++c) charts[c] = with_axes(std::move(charts[c]), mesh, along[c]);
  return charts;
}

PackedCharts packed_charts(const std::vector<LightmapChart>& charts, const std::optional<double>& texel) {
  if (!texel) {
    const int least_cell = (1 + 2 * lightmap_padding) * (1 + 2 * lightmap_padding);
    int edge = 256;
    const double least_area = static_cast<double>(charts.size()) * least_cell;
    while (edge < most_lightmap_edge && 0.5 * edge * edge < least_area) edge *= 2;
    for (; edge <= most_lightmap_edge; edge *= 2) {
      if (auto packed = fitted_into(charts, edge)) return *std::move(packed);
    }
    refuse_so_many(charts.size());
  }
  for (int edge = 16; edge <= most_lightmap_edge; edge *= 2) {
    if (auto packed = packed_into(charts, edge, *texel)) return *std::move(packed);
  }
  if (auto fitted = fitted_into(charts, most_lightmap_edge)) return *std::move(fitted);
  refuse_so_many(charts.size());
}

Lightmap with_padding(Lightmap map, int texels) {
  Padding padding(std::move(map));
  for (int ring = 0; ring < texels; ++ring) padding.grow(ring == 0);
  return std::move(padding).map();
}

}  // namespace patchlight
