#include "patchlight/transport/assemble.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "form_factor/point_polygon.h"
#include "mesh/patch_lookup.h"
#include "transport/pair_sampler.h"
#include "transport/sights.h"
#include "transport/tiles.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <map>
#include <utility>

namespace patchlight {
namespace {

struct Assembler {
  bool keeps_errors;
  const ClusterPairs& pairs;
  const KnownEntries* known;  // none: null

  LaneMask new_lanes(std::size_t cluster) const;
  bool is_known(const ClusterPair& pair) const { return (new_lanes(pair.row) | new_lanes(pair.column)) == 0; }

  template <typename Use>
  void for_all_facing(const ClusterPair& pair, AssemblyCounts& counts, Use use) const;
  AssemblyCounts fill_row(std::size_t row, Assembly& result) const;
};

// The patches of a cluster of which not all is known.
LaneMask Assembler::new_lanes(std::size_t cluster) const {
  if (known == nullptr) return all_lanes;
  const PatchCluster& of = pairs.clusters()[cluster];
  unsigned lanes = 0;
  for (int lane = 0; lane < of.size; ++lane) {
    if (known->place[of.patches[static_cast<std::size_t>(lane)]] == no_patch) lanes |= 1U << lane;
  }
  return static_cast<LaneMask>(lanes);
}

// ClusterPairs::for_facing() for all pairs of two clusters that are not known, counted.
template <typename Use>
void Assembler::for_all_facing(const ClusterPair& pair, AssemblyCounts& counts, Use use) const {
  const auto counted = [&](PatchIndex i, PatchIndex j, float unoccluded) {
    counts.near_pairs += unoccluded < 0 && is_near(pairs.shapes()[i], pairs.shapes()[j]) ? 1 : 0;
    ++counts.facing_pairs;
    use(i, j, unoccluded);
  };
  const LaneMask new_rows = new_lanes(pair.row);
  const auto known_rows = static_cast<LaneMask>(~new_rows);
  if (new_rows != 0) pairs.for_facing(pair, new_rows, all_lanes, counted);
  if (known_rows != 0) pairs.for_facing(pair, known_rows, new_lanes(pair.column), counted);
}

// The results of shadow rays.
AssemblyCounts counts_of(const Pair& pair) {
  const double share = pair.visible_share();
  AssemblyCounts counts;
  counts.shadow_rays = pair.rays();
  counts.partial_pairs = share > 0 && share < 1 ? 1 : 0;
  counts.blocked_pairs = share == 0 ? 1 : 0;
  return counts;
}

// The entries of one cluster with itself and all later ones.
AssemblyCounts Assembler::fill_row(std::size_t row, Assembly& result) const {
  AssemblyCounts counts;
  ExchangeAreas& S = result.exchange_areas;
  const std::vector<PatchCluster>& clusters = pairs.clusters();
  const PairSampler& sampler = pairs.sampler();
  std::vector<Pair> sampled;
  for (std::size_t column = row; column < clusters.size(); ++column) {
    const ClusterPair both{row, column};
    if (is_known(both)) continue;
    const PairClass pair_class = pairs.class_of(both);
    if (pair_class == PairClass::averted) continue;
    if (pair_class == PairClass::free) {
      for_all_facing(both, counts, [&](PatchIndex i, PatchIndex j, float unoccluded) {
        S.set(i, j, unoccluded < 0 ? sampler.exact(i, j) : unoccluded);
        ++counts.free_pairs;
      });
      continue;
    }
    if (pair_class == PairClass::hidden) {
      counts.hidden_pairs +=
          static_cast<std::uint64_t>(clusters[row].size) * static_cast<std::uint64_t>(clusters[column].size);
      continue;
    }
    sampled.clear();
    for_all_facing(both, counts, [&](PatchIndex i, PatchIndex j, float unoccluded) {
      sampled.push_back(sampler.new_pair(i, j, unoccluded));
    });
    sampled = sampler.sampled(std::move(sampled));
    for (const Pair& pair : sampled) {
      S.set(pair.first, pair.second, narrow_toward_zero(sampler.exchange_area(pair)));
      if (keeps_errors) result.half_differences.set(pair.first, pair.second, sampler.half_difference(pair));
      counts += counts_of(pair);
    }
  }
  return counts;
}

// Adds the known entries.
Assembly with_known(Assembly assembly, const KnownEntries& known) {
  const Assembly& from = known.assembly;
  parallel_for(known.place.size(), [&](std::size_t row) {
    const auto j = static_cast<PatchIndex>(row);
    if (known.place[j] == no_patch) return;
    for (PatchIndex i = 0; i < j; ++i) {
      if (known.place[i] == no_patch) continue;
      assembly.exchange_areas.set(i, j, from.exchange_areas.at(known.place[i], known.place[j]));
      if (assembly.half_differences.size() > 0)
        assembly.half_differences.copy(i, j, from.half_differences, {known.place[i], known.place[j]});
    }
  });
  return assembly;
}

// Closed forms, and shadow rays where something may be in between.
Assembly by_pair_class(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                       const KnownEntries* known, const Observer& observer) {
  const ClusterPairs pairs(mesh, occluder, options);
  const Assembler assembler{options.keep_errors, pairs, known};
  Assembly result{ExchangeAreas(mesh.size()), {}, options.keep_errors ? HalfDifferences(mesh.area) : HalfDifferences()};
  std::vector<AssemblyCounts> rows(pairs.clusters().size());
  parallel_for(rows.size(), Stage::form_factors, observer,
               [&](std::size_t row) { rows[row] = assembler.fill_row(row, result); });
  for (const AssemblyCounts& row : rows) result.counts += row;
  if (known == nullptr) return result;
  return with_known(std::move(result), *known);
}

// The estimators for study. Each is plain: no clusters, no short cuts.

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

  // 2. Their sums.
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
    const double nonspecular = occluder.optics().nonspecular_fraction(mesh.polygon[i], mesh.side[i]) *
                               occluder.optics().nonspecular_fraction(mesh.polygon[j], mesh.side[j]);
    S.set(i, j, narrow_toward_zero(nonspecular * estimator.use(shapes[i], shapes[j], means)));
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
    if (pairs.size() * pairs.front().samples.size() < rays_at_once) continue;
    counts += trace(pairs, S);
    pairs.clear();
  }
  counts += trace(pairs, S);
  return counts;
}

// Every pair of patches that face each other, one after the other. The points are scrambled Sobol sequences, one for
// each pair.
Assembly pair_by_pair(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                      const PairEstimator& estimator, const Observer& observer) {
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  const PairLoop loop{mesh, occluder, options, estimator, shapes, keys};
  Assembly result{ExchangeAreas(mesh.size()), {}, {}};
  std::vector<AssemblyCounts> rows(mesh.size());
  parallel_for(rows.size(), Stage::form_factors, observer, [&](std::size_t row) {
    rows[row] = loop.fill_row(static_cast<PatchIndex>(row), result.exchange_areas);
  });
  for (const AssemblyCounts& row : rows) result.counts += row;
  return result;
}

// S = A_i A_j mean(G V) over pairs of points, uniform on both patches. No finite variance for patches that touch.
Assembly estimate_by_area(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                          const Observer& observer) {
  const auto visible = [](const PatchShape&, const PatchShape&, const SampleMeans& means) { return means.visible; };
  return pair_by_pair(mesh, occluder, options, {draw_by_area, visible}, observer);
}

// S = U sum(G V) / sum(G): the contour integral U times the visible share of the samples of estimate_by_area().
Assembly estimate_by_contour(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                             const Observer& observer) {
  const auto share_of_contour = [](const PatchShape& first, const PatchShape& second, const SampleMeans& means) {
    const double U = contour_exchange_area(first.corners, second.corners);
    // If no sample has a weight, the pair counts as visible.
    return means.blocked != 0 ? U * means.visible / (means.visible + means.blocked) : U;
  };
  return pair_by_pair(mesh, occluder, options, {draw_by_area, share_of_contour}, observer);
}

PairSample draw_by_solid_angle(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at) {
  const Point x = square_to_quad(smaller.corners.points, at[0], at[1]);
  const PolygonSample y = sample_solid_angle(x, smaller.normal, larger.corners, at[2], at[3]);
  const double exact = point_to_polygon(x, smaller.normal, larger.corners);
  return {x, y.point, smaller.area * y.weight, smaller.area * exact};
}

// The exact value less the blocked part, a control variate, unless most is blocked: the error is that of the smaller
// part.
double exchange_area(const PatchShape&, const PatchShape&, const SampleMeans& means) {
  if (means.visible < means.blocked) return means.visible;
  return std::max(0.0, means.unoccluded - means.blocked);
}

// S = A_i mean(F(x)) - A_i mean(w (1 - V)) over points x of the smaller patch: F is the exact form factor from x to the
// larger one, w the weight of a ray to a point chosen in its solid angle. Where most weight is blocked A_i mean(w V).
Assembly estimate_by_points(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            const Observer& observer) {
  return pair_by_pair(mesh, occluder, options, {draw_by_solid_angle, exchange_area}, observer);
}

// How many rays arrived at which patch.
using Arrivals = std::map<PatchIndex, std::uint32_t>;

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
      rays.push_back({start, frame * occluder.optics().sample_nonspecular_direction(mesh.polygon[from], s, t),
                      mesh.polygon[from]});
    }
    if (rays.size() < rays_at_once && k + 1 < points.size()) continue;
    for (const auto& hit : occluder.sample_nonspecular_hits(rays, hash({seed, k}))) {
      const auto patch = hit ? patches.patch_at(hit->polygon, hit->side, hit->point) : std::nullopt;
      if (patch) ++arrived[*patch];
    }
    rays.clear();
  }
  return arrived;
}

// S = (A_i n_ij + A_j n_ji) / (2 s) with n_ij of s cosine-distributed rays from patch i arriving at patch j first.
Assembly estimate_by_hemisphere(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                const Observer& observer) {
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  const PatchLookup patches(mesh);
  const Hemisphere hemisphere{mesh, occluder, patches};
  std::vector<Arrivals> arrived(mesh.size());
  parallel_for(arrived.size(), Stage::form_factors, observer, [&](std::size_t i) {
    const std::uint32_t seed = hash({options.seed, keys[i], stream::row_estimate});
    const auto points = scrambled_sobol(static_cast<std::uint32_t>(options.samples), seed);
    arrived[i] = hemisphere.arrivals(static_cast<PatchIndex>(i), points, seed);
  });

  Assembly result{ExchangeAreas(mesh.size()), {}, {}};
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const auto& [j, count] : arrived[i]) {
      const double before = static_cast<double>(result.exchange_areas.at(i, j));
      result.counts.facing_pairs += before == 0 ? 1 : 0;
      const double nonspecular = occluder.optics().nonspecular_fraction(mesh.polygon[i], mesh.side[i]);
      const double area = before + nonspecular * mesh.area[i] * count / (2.0 * options.samples);
      result.exchange_areas.set(i, j, narrow_toward_zero(area));
    }
  }
  result.counts.shadow_rays = static_cast<std::uint64_t>(mesh.size()) * static_cast<std::uint64_t>(options.samples);
  return result;
}

}  // namespace

AssemblyCounts& AssemblyCounts::operator+=(const AssemblyCounts& other) {
  facing_pairs += other.facing_pairs;
  near_pairs += other.near_pairs;
  hidden_pairs += other.hidden_pairs;
  free_pairs += other.free_pairs;
  partial_pairs += other.partial_pairs;
  blocked_pairs += other.blocked_pairs;
  shadow_rays += other.shadow_rays;
  return *this;
}

const char* name_of(Estimator estimator) {
  switch (estimator) {
    case Estimator::automatic:
      return "auto";
    case Estimator::area:
      return "area";
    case Estimator::point_polygon:
      return "point-polygon";
    case Estimator::hemisphere:
      return "hemisphere";
    case Estimator::contour:
      return "contour";
  }
  return "";
}

const char* name_of(Storage storage) {
  switch (storage) {
    case Storage::automatic:
      return "auto";
    case Storage::tiles:
      return "tiles";
    case Storage::rays:
      return "rays";
    case Storage::on_demand:
      return "on-demand";
  }
  return "";
}

Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                 const Observer& observer) {
  assert(options.samples >= 1);
  switch (options.estimator) {
    case Estimator::automatic:
      break;
    case Estimator::area:
      return estimate_by_area(mesh, occluder, options, observer);
    case Estimator::point_polygon:
      return estimate_by_points(mesh, occluder, options, observer);
    case Estimator::hemisphere:
      return estimate_by_hemisphere(mesh, occluder, options, observer);
    case Estimator::contour:
      return estimate_by_contour(mesh, occluder, options, observer);
  }
  return by_pair_class(mesh, occluder, options, nullptr, observer);
}

Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                 const KnownEntries& known, const Observer& observer) {
  assert(options.estimator == Estimator::automatic && known.place.size() == mesh.size());
  assert(!options.keep_errors || known.assembly.half_differences.size() == known.assembly.exchange_areas.size());
  return by_pair_class(mesh, occluder, options, &known, observer);
}

}  // namespace patchlight
