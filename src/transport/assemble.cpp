#include "patchlight/transport/assemble.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "transport/estimators.h"
#include "transport/pair_sampler.h"
#include "transport/tiles.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// One of so many sampled pairs is sampled a second time, to learn the error of all: some thousand pairs, or one in 256.
// Of estimates, which are fewer and differ more, at least one in 16.
std::uint32_t audit_interval(PatchIndex size, bool estimated) {
  const double pairs = static_cast<double>(size) * size;
  return static_cast<std::uint32_t>(std::clamp(pairs / 16384, 4.0, estimated ? 16.0 : 256.0));
}

EntryKind kind_of(const Pair& pair) {
  const double share = pair.visible_share();
  return share == 0 ? EntryKind::all_hidden : share == 1 ? EntryKind::all_visible : EntryKind::estimated;
}

// What one row of clusters adds to the result.
struct RowFacts {
  AssemblyCounts counts;
  SamplingError error;
};

struct Assembler {
  const PatchMesh& mesh;
  const AssemblyOptions& options;
  const ClusterPairs& pairs;
  const KnownEntries* known;  // none: null

  LaneMask new_lanes(std::size_t cluster) const;
  bool is_known(const ClusterPair& pair) const { return (new_lanes(pair.row) | new_lanes(pair.column)) == 0; }

  template <typename Use>
  void for_all_facing(const ClusterPair& pair, AssemblyCounts& counts, Use use) const;
  void count(const Pair& pair, RowFacts& facts) const;
  void audit(const Pair& pair, double exchange_area, RowFacts& facts) const;
  RowFacts fill_row(std::size_t row, ExchangeAreas& S, EntryErrors& errors) const;
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

void Assembler::count(const Pair& pair, RowFacts& facts) const {
  facts.counts.shadow_rays += pair.rays();
  facts.counts.partial_pairs += kind_of(pair) == EntryKind::estimated ? 1 : 0;
  facts.counts.blocked_pairs += kind_of(pair) == EntryKind::all_hidden ? 1 : 0;
}

// Samples one of many pairs again, independently: the difference tells the error of pairs like it.
void Assembler::audit(const Pair& pair, double exchange_area, RowFacts& facts) const {
  const bool estimated = kind_of(pair) == EntryKind::estimated;
  if (hash({pair.first, pair.second, options.seed}) % audit_interval(mesh.size(), estimated) != 0) return;
  const Pair again = pairs.sampler().sampled_again(pair);
  facts.counts.shadow_rays += again.rays();
  // Patches nearly in one plane may have nothing to compare with.
  if (!(again.unoccluded > 0)) return;
  const double share = exchange_area / again.unoccluded;
  const double difference = share - pairs.sampler().exchange_area(again) / again.unoccluded;
  const double smaller = std::min(mesh.area[pair.first], mesh.area[pair.second]);
  const double form_factor = again.unoccluded / smaller;
  const std::size_t effort = effort_index(sampling_effort(form_factor));
  const double square = form_factor * form_factor;
  const AuditedPairs audited{1, square * difference * difference / 2, square};
  if (estimated) {
    const auto bin = static_cast<std::size_t>(std::min(share * SamplingError::bins, SamplingError::bins - 1.0));
    facts.error.partial[effort][bin] += audited;
    return;
  }
  const bool visible = kind_of(pair) == EntryKind::all_visible;
  SamplingError::Unanimous& unanimous = visible ? facts.error.visible : facts.error.occluded;
  unanimous.audited[effort] += audited;
  unanimous.missed += kind_of(again) != kind_of(pair) ? 1 : 0;
  constexpr std::size_t steps = SamplingError::Unanimous::steps;
  ++unanimous.by_share[static_cast<std::size_t>(std::min(std::abs(difference) * steps, steps - 1.0))];
}

// The entries of one cluster with itself and all later ones. Until the sampling error is known, the unoccluded exchange
// areas stand in place of the standard errors.
RowFacts Assembler::fill_row(std::size_t row, ExchangeAreas& S, EntryErrors& errors) const {
  RowFacts facts;
  AssemblyCounts& counts = facts.counts;
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
      const float area = narrow_toward_zero(sampler.exchange_area(pair));
      S.set(pair.first, pair.second, area);
      count(pair, facts);
      audit(pair, area, facts);
      if (options.keep_errors) errors.set(pair.first, pair.second, kind_of(pair), pair.unoccluded);
    }
  }
  return facts;
}

// Adds what is known.
Assembly with_known(Assembly assembly, const KnownEntries& known) {
  const Assembly& from = known.assembly;
  parallel_for(known.place.size(), [&](std::size_t row) {
    const auto j = static_cast<PatchIndex>(row);
    if (known.place[j] == no_patch) return;
    for (PatchIndex i = 0; i < j; ++i) {
      if (known.place[i] == no_patch) continue;
      assembly.exchange_areas.set(i, j, from.exchange_areas.at(known.place[i], known.place[j]));
      if (assembly.entry_errors.size() > 0)
        assembly.entry_errors.copy(i, j, from.entry_errors, {known.place[i], known.place[j]});
    }
  });
  return assembly;
}

// Closed forms, and shadow rays where something may be in between.
Assembly by_pair_class(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                       const KnownEntries* known, const Observer& observer) {
  const ClusterPairs pairs(mesh, occluder, options);
  const Assembler assembler{mesh, options, pairs, known};
  Assembly result{ExchangeAreas(mesh.size()), {}, {}, options.keep_errors ? EntryErrors(mesh.area) : EntryErrors()};
  std::vector<RowFacts> rows(pairs.clusters().size());
  parallel_for(rows.size(), Stage::form_factors, observer, [&](std::size_t row) {
    rows[row] = assembler.fill_row(row, result.exchange_areas, result.entry_errors);
  });
  if (known != nullptr) result.error = known->assembly.error;
  for (const RowFacts& row : rows) {
    result.counts += row.counts;
    result.error += row.error;
  }
  result.entry_errors =
      with_sampling_error(std::move(result.entry_errors), result.exchange_areas, result.error, mesh.area);
  if (known == nullptr) return result;
  return with_known(std::move(result), *known);
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
      return by_pair_class(mesh, occluder, options, nullptr, observer);
    case Estimator::area:
      return estimate_by_area(mesh, occluder, options, observer);
    case Estimator::point_polygon:
      return estimate_by_points(mesh, occluder, options, observer);
    case Estimator::hemisphere:
      return estimate_by_hemisphere(mesh, occluder, options, observer);
    case Estimator::contour:
      return estimate_by_contour(mesh, occluder, options, observer);
  }
  assert(false);
  return by_pair_class(mesh, occluder, options, nullptr, observer);
}

Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                 const KnownEntries& known, const Observer& observer) {
  assert(options.estimator == Estimator::automatic && known.place.size() == mesh.size());
  assert(!options.keep_errors || known.assembly.entry_errors.size() == known.assembly.exchange_areas.size());
  return by_pair_class(mesh, occluder, options, &known, observer);
}

}  // namespace patchlight
