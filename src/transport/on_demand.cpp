#include "transport/on_demand.h"

#include "base/parallel.h"
#include "transport/cluster_pairs.h"
#include "transport/narrow.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Rows found together, so that clusters are looked at once for several of their patches.
constexpr PatchIndex rows_at_once = 64;

// Where a patch stands among the clusters.
struct Place {
  std::size_t cluster = 0;
  int lane = 0;
};

std::vector<Place> places(const std::vector<PatchCluster>& clusters, PatchIndex size) {
  std::vector<Place> places(size);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (int lane = 0; lane < clusters[c].size; ++lane) {
      places[clusters[c].patches[static_cast<std::size_t>(lane)]] = {c, lane};
    }
  }
  return places;
}

class OnDemandTransport : public RowTransport {
 public:
  OnDemandTransport(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                    Eigen::VectorXd area)
      : pairs_(mesh, occluder, options), places_(places(pairs_.clusters(), mesh.size())), area_(std::move(area)) {}

  PatchIndex size() const override { return static_cast<PatchIndex>(places_.size()); }
  Field apply(const FieldView& radiosity) const override { return gather({0, size()}, radiosity); }
  Field gather(PatchRange receivers, const FieldView& radiosity) const override;
  Field shoot(PatchRange sources, const FieldView& radiosity) const override;
  Eigen::MatrixXd form_factors(PatchRange from, PatchRange to) const override;

 private:
  std::vector<std::vector<float>> rows(PatchRange patches) const;
  template <typename Use>
  void for_rows(PatchRange patches, Use use) const;
  template <typename Use>
  void for_exchange_areas(const ClusterPair& pair, LaneMask rows, LaneMask columns, Use use) const;

  ClusterPairs pairs_;
  std::vector<Place> places_;
  Eigen::VectorXd area_;
};

// Calls use(i, j, S_ij) for the pairs of these patches whose exchange area may differ from 0.
template <typename Use>
void OnDemandTransport::for_exchange_areas(const ClusterPair& pair, LaneMask rows, LaneMask columns, Use use) const {
  const PairClass pair_class = pairs_.class_of(pair);
  if (pair_class == PairClass::averted || pair_class == PairClass::hidden) return;
  const PairSampler& sampler = pairs_.sampler();
  if (pair_class == PairClass::free) {
    pairs_.for_facing(pair, rows, columns, [&](PatchIndex i, PatchIndex j, float unoccluded) {
      use(i, j, unoccluded < 0 ? sampler.exact(i, j) : unoccluded);
    });
    return;
  }
  std::vector<Pair> pairs;
  pairs_.for_facing(pair, rows, columns, [&](PatchIndex i, PatchIndex j, float unoccluded) {
    pairs.push_back(sampler.new_pair(i, j, unoccluded));
  });
  for (const Pair& sampled : sampler.sampled(std::move(pairs))) {
    use(sampled.first, sampled.second, narrow_toward_zero(sampler.exchange_area(sampled)));
  }
}

// S_ij of these patches i with all patches j, in m^2; those of one cluster are found together. Of the two clusters of a
// pair the one with the lower number comes first, as in the whole matrix: rounding depends on it.
std::vector<std::vector<float>> OnDemandTransport::rows(PatchRange patches) const {
  std::map<std::size_t, LaneMask> lanes_of;
  for (PatchIndex i = patches.begin; i < patches.end; ++i) {
    LaneMask& lanes = lanes_of[places_[i].cluster];
    lanes = static_cast<LaneMask>(lanes | 1U << static_cast<unsigned>(places_[i].lane));
  }
  std::vector<std::vector<float>> S(patches.end - patches.begin, std::vector<float>(size()));
  const auto set_row = [&](PatchIndex i, PatchIndex j, float area) {
    if (i >= patches.begin && i < patches.end) S[i - patches.begin][j] = area;
  };
  const auto set = [&](PatchIndex i, PatchIndex j, float area) {
    set_row(i, j, area);
    set_row(j, i, area);
  };
  for (const auto& [cluster, lanes] : lanes_of) {
    parallel_for(pairs_.clusters().size(), [&, own = cluster, wanted = lanes](std::size_t other) {
      if (own <= other) for_exchange_areas({own, other}, wanted, all_lanes, set);
      if (other <= own) for_exchange_areas({other, own}, all_lanes, wanted, set);
    });
  }
  return S;
}

// Calls use(i, row of i) in order for these patches.
template <typename Use>
void OnDemandTransport::for_rows(PatchRange patches, Use use) const {
  for (PatchIndex begin = patches.begin; begin < patches.end; begin += rows_at_once) {
    const PatchRange some{begin, std::min(begin + rows_at_once, patches.end)};
    const std::vector<std::vector<float>> S = rows(some);
    for (PatchIndex i = some.begin; i < some.end; ++i) use(i, S[i - some.begin]);
  }
}

Field OnDemandTransport::gather(PatchRange receivers, const FieldView& radiosity) const {
  assert(receivers.begin <= receivers.end && receivers.end <= size());
  Field irradiance = Field::Zero(receivers.end - receivers.begin, radiosity.cols());
  for_rows(receivers, [&](PatchIndex i, const std::vector<float>& S) {
    auto H = irradiance.row(i - receivers.begin);
    for (PatchIndex j = 0; j < size(); ++j) H += static_cast<double>(S[j]) * radiosity.row(j);
    H /= area_[i];
  });
  return irradiance;
}

Field OnDemandTransport::shoot(PatchRange sources, const FieldView& radiosity) const {
  assert(sources.begin <= sources.end && sources.end <= size());
  Field irradiance = Field::Zero(size(), radiosity.cols());
  for_rows(sources, [&](PatchIndex j, const std::vector<float>& S) {
    const auto B = radiosity.row(j - sources.begin);
    for (PatchIndex i = 0; i < size(); ++i) irradiance.row(i) += static_cast<double>(S[i]) * B;
  });
  return irradiance.colwise() / area_.array();
}

Eigen::MatrixXd OnDemandTransport::form_factors(PatchRange from, PatchRange to) const {
  Eigen::MatrixXd F(from.end - from.begin, to.end - to.begin);
  for_rows(from, [&](PatchIndex i, const std::vector<float>& S) {
    for (PatchIndex j = to.begin; j < to.end; ++j) {
      F(i - from.begin, j - to.begin) = static_cast<double>(S[j]) / area_[i];
    }
  });
  return F;
}

}  // namespace

std::unique_ptr<RowTransport> on_demand_transport(const PatchMesh& mesh, const Occluder& occluder,
                                                  const AssemblyOptions& options, Eigen::VectorXd area) {
  assert(options.estimator == Estimator::automatic);
  assert(options.samples >= 1);
  return std::make_unique<OnDemandTransport>(mesh, occluder, options, std::move(area));
}

}  // namespace patchlight
