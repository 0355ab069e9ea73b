#include "transport/estimators.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "form_factor/pair_samples.h"
#include "form_factor/patch_shape.h"
#include "form_factor/point_polygon.h"
#include "mesh/patch_lookup.h"
#include "transport/sights.h"
#include "transport/tiles.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// The sample that belongs to a point of the unit hypercube. The smaller patch comes first.
using DrawSample =
    std::function<PairSample(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at)>;

// Means over the samples of a pair, m^2.
struct SampleMeans {
  double visible = 0;     // of weight V
  double blocked = 0;     // of weight (1 - V)
  double unoccluded = 0;  // of PairSample::unoccluded
};

// The exchange area that follows, m^2.
using UseMeans = std::function<double(const PatchShape& smaller, const PatchShape& larger, const SampleMeans& means)>;

// How the exchange area of a pair is found from options.samples shadow rays.
struct PairEstimator {
  DrawSample draw;
  UseMeans use;
};

constexpr std::size_t shadow_rays_at_once = 4096;

struct PairLoop {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const AssemblyOptions& options;
  const PairEstimator& estimator;
  const std::vector<PatchShape>& shapes;
  const std::vector<std::uint32_t>& keys;

  AssemblyCounts fill_row(PatchIndex i, ExchangeAreas& S) const;

 private:
  struct Drawn {
    std::array<PatchIndex, 2> patches;
    std::vector<PairSample> samples;
  };
  Drawn draw(PatchIndex i, PatchIndex j) const;
  AssemblyCounts trace(const std::vector<Drawn>& pairs, ExchangeAreas& S) const;
};

PairLoop::Drawn PairLoop::draw(PatchIndex i, PatchIndex j) const {
  if (shapes[j].area < shapes[i].area) std::swap(i, j);
  Drawn pair{{i, j}, {}};
  const auto points =
      scrambled_sobol(static_cast<std::uint32_t>(options.samples), hash({options.seed, keys[i], keys[j]}));
  pair.samples.reserve(points.size());
  for (const auto& at : points) pair.samples.push_back(estimator.draw(shapes[i], shapes[j], at));
  return pair;
}

AssemblyCounts PairLoop::trace(const std::vector<Drawn>& pairs, ExchangeAreas& S) const {
  AssemblyCounts counts;
  // 1. The rays that carry weight.
  std::vector<Segment> segments;
  for (const Drawn& pair : pairs) {
    for (const PairSample& sample : pair.samples) {
      if (!(sample.weight > 0)) continue;
      segments.push_back({sample.from, sample.to, mesh.polygon[pair.patches[0]], mesh.polygon[pair.patches[1]]});
    }
  }
  const std::vector<float> arriving = occluder.transmittance(segments);
  counts.shadow_rays = segments.size();

  // 2. What they add up to.
  std::size_t next = 0;
  for (const Drawn& pair : pairs) {
    SampleMeans sums;
    for (const PairSample& sample : pair.samples) {
      sums.unoccluded += sample.unoccluded;
      if (!(sample.weight > 0)) continue;
      const double share = arriving[next++];
      sums.visible += share * sample.weight;
      sums.blocked += (1 - share) * sample.weight;
    }
    const auto count = static_cast<double>(pair.samples.size());
    const SampleMeans means{sums.visible / count, sums.blocked / count, sums.unoccluded / count};
    const auto [i, j] = pair.patches;
    const double held =
        occluder.held_share(mesh.polygon[i], mesh.side[i]) * occluder.held_share(mesh.polygon[j], mesh.side[j]);
    S.set(i, j, narrow_toward_zero(held * estimator.use(shapes[i], shapes[j], means)));
    counts.partial_pairs += sums.visible > 0 && sums.blocked > 0 ? 1 : 0;
    counts.blocked_pairs += sums.visible == 0 && sums.blocked > 0 ? 1 : 0;
  }
  counts.facing_pairs = pairs.size();
  return counts;
}

// The pairs of patch i with all later ones.
AssemblyCounts PairLoop::fill_row(PatchIndex i, ExchangeAreas& S) const {
  AssemblyCounts counts;
  std::vector<Drawn> pairs;
  for (PatchIndex j = i + 1; j < mesh.size(); ++j) {
    if (mesh.polygon[i] == mesh.polygon[j] || orientation(shapes[i], shapes[j]) == Orientation::averted) continue;
    counts.near_pairs += is_near(shapes[i], shapes[j]) ? 1 : 0;
    pairs.push_back(draw(i, j));
    if (pairs.size() * pairs.front().samples.size() < shadow_rays_at_once) continue;
    counts += trace(pairs, S);
    pairs.clear();
  }
  counts += trace(pairs, S);
  return counts;
}

// Every pair of patches that face each other, one after the other. The points are scrambled Sobol sequences, one for
// each pair. Throws Cancelled.
Assembly pair_by_pair(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                      const PairEstimator& estimator, const Observer& observer) {
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  const PairLoop loop{mesh, occluder, options, estimator, shapes, keys};
  Assembly result{ExchangeAreas(mesh.size()), {}, {}, {}};
  std::vector<AssemblyCounts> rows(mesh.size());
  parallel_for(rows.size(), Stage::form_factors, observer, [&](std::size_t row) {
    rows[row] = loop.fill_row(static_cast<PatchIndex>(row), result.exchange_areas);
  });
  for (const AssemblyCounts& row : rows) result.counts += row;
  return result;
}

}  // namespace

PairSample draw_by_area(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at) {
  const Point x = square_to_quad(smaller.corners.points, at[0], at[1]);
  const Point y = square_to_quad(larger.corners.points, at[2], at[3]);
  return {x, y, smaller.area * larger.area * geometry_term(x, smaller.normal, y, larger.normal), 0};
}

Assembly estimate_by_area(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                          const Observer& observer) {
  const auto visible = [](const PatchShape&, const PatchShape&, const SampleMeans& means) { return means.visible; };
  return pair_by_pair(mesh, occluder, options, {draw_by_area, visible}, observer);
}

Assembly estimate_by_contour(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                             const Observer& observer) {
  const auto share_of_contour = [](const PatchShape& first, const PatchShape& second, const SampleMeans& means) {
    const double U = contour_exchange_area(first.corners, second.corners);
    // Without a sample that says otherwise the pair counts as visible.
    return means.blocked != 0 ? U * means.visible / (means.visible + means.blocked) : U;
  };
  return pair_by_pair(mesh, occluder, options, {draw_by_area, share_of_contour}, observer);
}

namespace {

PairSample draw_by_solid_angle(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at) {
  const Point x = square_to_quad(smaller.corners.points, at[0], at[1]);
  const PolygonSample y = sample_solid_angle(x, smaller.normal, larger.corners, at[2], at[3]);
  const double exact = point_to_polygon(x, smaller.normal, larger.corners);
  return {x, y.point, smaller.area * y.weight, smaller.area * exact};
}

// The exact value less what is blocked, a control variate, unless most is blocked: the error is that of the smaller
// part.
double exchange_area(const PatchShape&, const PatchShape&, const SampleMeans& means) {
  if (means.visible < means.blocked) return means.visible;
  return std::max(0.0, means.unoccluded - means.blocked);
}

}  // namespace

Assembly estimate_by_points(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            const Observer& observer) {
  return pair_by_pair(mesh, occluder, options, {draw_by_solid_angle, exchange_area}, observer);
}

namespace {

// How many rays arrived at which patch.
using Arrivals = std::map<PatchIndex, std::uint32_t>;

constexpr std::size_t rays_at_once = 4096;

struct Hemisphere {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const PatchLookup& patches;

  Arrivals arrivals(PatchIndex from, const std::vector<std::array<double, 4>>& points, std::uint32_t seed) const;
};

Arrivals Hemisphere::arrivals(PatchIndex from, const std::vector<std::array<double, 4>>& points,
                              std::uint32_t seed) const {
  const PatchCorners corners = mesh.corner_points(from);
  const Eigen::Matrix3d frame = patch_frame(mesh, from);
  Arrivals arrived;
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto& [u, v, s, t] = points[k];
    const Point start = square_to_quad(corners.points, u, v);
    if (!occluder.is_covered(mesh.polygon[from], mesh.side[from], start)) {
      rays.push_back({start, frame * occluder.held_direction(mesh.polygon[from], s, t), mesh.polygon[from]});
    }
    if (rays.size() < rays_at_once && k + 1 < points.size()) continue;
    for (const auto& hit : occluder.first_held_hits(rays, hash({seed, k}))) {
      const auto patch = hit ? patches.patch_at(hit->polygon, hit->side, hit->point) : std::nullopt;
      if (patch) ++arrived[*patch];
    }
    rays.clear();
  }
  return arrived;
}

}  // namespace

Assembly estimate_by_hemisphere(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                const Observer& observer) {
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  const PatchLookup patches(mesh);
  const Hemisphere hemisphere{mesh, occluder, patches};
  std::vector<Arrivals> arrived(mesh.size());
  parallel_for(arrived.size(), Stage::form_factors, observer, [&](std::size_t i) {
    const std::uint32_t seed = hash({options.seed, keys[i], 2});
    const auto points = scrambled_sobol(static_cast<std::uint32_t>(options.samples), seed);
    arrived[i] = hemisphere.arrivals(static_cast<PatchIndex>(i), points, seed);
  });

  // S_ij = (A_i n_ij + A_j n_ji) / (2 s)
  Assembly result{ExchangeAreas(mesh.size()), {}, {}, {}};
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const auto& [j, count] : arrived[i]) {
      const double before = static_cast<double>(result.exchange_areas.at(i, j));
      result.counts.facing_pairs += before == 0 ? 1 : 0;
      const double held = occluder.held_share(mesh.polygon[i], mesh.side[i]);
      const double area = before + held * mesh.area[i] * count / (2.0 * options.samples);
      result.exchange_areas.set(i, j, narrow_toward_zero(area));
    }
  }
  result.counts.shadow_rays = static_cast<std::uint64_t>(mesh.size()) * static_cast<std::uint64_t>(options.samples);
  return result;
}

}  // namespace patchlight
