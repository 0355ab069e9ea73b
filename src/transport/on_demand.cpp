#include "patchlight/transport/on_demand.h"

#include "patchlight/base/parallel.h"

#include "transport/cluster_pairs.h"
#include "transport/narrow.h"

#include <cassert>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

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
  std::vector<float> row(PatchIndex patch) const;
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

// S_ij of one patch i with all patches j, in m^2. Of the two clusters of a pair the one with the lower number comes
// first, as in the whole matrix: rounding depends on it.
std::vector<float> OnDemandTransport::row(PatchIndex patch) const {
  const Place place = places_[patch];
  const auto lane = static_cast<LaneMask>(1U << static_cast<unsigned>(place.lane));
  std::vector<float> S(size());
  const auto set = [&](PatchIndex i, PatchIndex j, float area) { S[i == patch ? j : i] = area; };
  parallel_for(pairs_.clusters().size(), [&](std::size_t other) {
    if (place.cluster <= other) for_exchange_areas({place.cluster, other}, lane, all_lanes, set);
    if (other <= place.cluster) for_exchange_areas({other, place.cluster}, all_lanes, lane, set);
  });
  return S;
}

Field OnDemandTransport::gather(PatchRange receivers, const FieldView& radiosity) const {
  assert(receivers.begin <= receivers.end && receivers.end <= size());
  Field irradiance = Field::Zero(receivers.end - receivers.begin, radiosity.cols());
  for (PatchIndex i = receivers.begin; i < receivers.end; ++i) {
    const std::vector<float> S = row(i);
    auto H = irradiance.row(i - receivers.begin);
    for (PatchIndex j = 0; j < size(); ++j) H += static_cast<double>(S[j]) * radiosity.row(j);
    H /= area_[i];
  }
  return irradiance;
}

Field OnDemandTransport::shoot(PatchRange sources, const FieldView& radiosity) const {
  assert(sources.begin <= sources.end && sources.end <= size());
  Field irradiance = Field::Zero(size(), radiosity.cols());
  for (PatchIndex j = sources.begin; j < sources.end; ++j) {
    const std::vector<float> S = row(j);
    const auto B = radiosity.row(j - sources.begin);
    for (PatchIndex i = 0; i < size(); ++i) irradiance.row(i) += static_cast<double>(S[i]) * B;
  }
  return irradiance.colwise() / area_.array();
}

Eigen::MatrixXd OnDemandTransport::form_factors(PatchRange from, PatchRange to) const {
  Eigen::MatrixXd F(from.end - from.begin, to.end - to.begin);
  for (PatchIndex i = from.begin; i < from.end; ++i) {
    const std::vector<float> S = row(i);
    for (PatchIndex j = to.begin; j < to.end; ++j) {
      F(i - from.begin, j - to.begin) = static_cast<double>(S[j]) / area_[i];
    }
  }
  return F;
}

}  // namespace

std::unique_ptr<RowTransport> on_demand_transport(const PatchMesh& mesh, const Occluder& occluder,
                                                  const AssemblyOptions& options, Eigen::VectorXd area) {
  assert(options.estimator == Estimator::automatic);
  assert(options.probes >= 1 && options.samples >= options.probes);
  return std::make_unique<OnDemandTransport>(mesh, occluder, options, std::move(area));
}

}  // namespace patchlight
