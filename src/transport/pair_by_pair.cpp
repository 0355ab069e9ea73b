#include "transport/pair_by_pair.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "form_factor/monte_carlo.h"
#include "form_factor/patch_keys.h"
#include "transport/narrow.h"
#include "visibility/occluder.h"

#include <utility>
#include <vector>

namespace patchlight {
namespace {

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

}  // namespace

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

PairSample draw_by_area(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at) {
  const Point x = square_to_quad(smaller.corners.points, at[0], at[1]);
  const Point y = square_to_quad(larger.corners.points, at[2], at[3]);
  return {x, y, smaller.area * larger.area * geometry_term(x, smaller.normal, y, larger.normal), 0};
}

}  // namespace patchlight
