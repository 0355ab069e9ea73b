#include "patchlight/base/error.h"
#include "patchlight/transport/transport_operator.h"

#include "base/parallel.h"
#include "transport/closure.h"
#include "transport/pair_sampler.h"
#include "transport/tiles.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <utility>
#include <vector>

namespace patchlight {

namespace {

// Ranges of at most 64 patches that emit.
std::vector<PatchRange> emitter_ranges(const FieldView& exitance) {
  std::vector<PatchRange> ranges;
  for (Eigen::Index row = 0; row < exitance.rows(); ++row) {
    if (!(exitance.row(row) > 0).any()) continue;
    const auto i = static_cast<PatchIndex>(row);
    if (!ranges.empty() && ranges.back().end == i && i - ranges.back().begin < 64) {
      ++ranges.back().end;
    } else {
      ranges.push_back({i, i + 1});
    }
  }
  return ranges;
}

}  // namespace

const Pockets* TransportOperator::pockets(const Eigen::ArrayXd&) const { return nullptr; }
std::unique_ptr<TransportOperator> TransportOperator::adjoint(const Eigen::VectorXd&) const { return nullptr; }

Field irradiance_by_emitters(const TransportOperator& transport, const FieldView& exitance, const Observer& observer) {
  if (transport.rows() == nullptr && (exitance > 0).any()) {
    if (observer && !observer({.stage = Stage::solve})) throw Canceled();
    return transport.apply(exitance);
  }
  Field H = Field::Zero(exitance.rows(), exitance.cols());
  for (const PatchRange& range : emitter_ranges(exitance)) {
    if (observer && !observer({.stage = Stage::solve})) throw Canceled();
    H += transport.rows()->shoot(range, exitance.middleRows(range.begin, range.end - range.begin));
  }
  return H;
}

// Gathers for one block after the other.
Sweep RowTransport::sweep(Sweep from, const Relax& there, const Relax& back) const {
  std::vector<PatchRange> ranges;
  for (PatchIndex begin = 0; begin < size(); begin += tile_edge)
    ranges.push_back({begin, std::min(size(), begin + tile_edge)});

  Field& B = from.radiosity;
  const auto relax_with = [&](const Relax& relax, PatchRange range) {
    const Eigen::Index rows = range.end - range.begin;
    B.middleRows(range.begin, rows) =
        relax({range, B.middleRows(range.begin, rows), gather(range, B), form_factors(range, range)});
  };
  for (const PatchRange range : ranges) relax_with(there, range);
  if (back) {
    for (auto range = ranges.rbegin(); range != ranges.rend(); ++range) relax_with(back, *range);
  }
  return {std::move(B), {}, {}};
}

namespace {

// The first of `count` blocks that belongs to a stripe.
PatchIndex first_of(std::size_t stripe, PatchIndex count) { return static_cast<PatchIndex>(stripe * count / stripes); }

class DenseTransport : public RowTransport {
 public:
  DenseTransport(ClosedExchangeAreas closed, Eigen::VectorXd area)
      : S_(std::move(closed.exchange_areas)), remainder_(std::move(closed.remainder)), area_(std::move(area)) {}

  PatchIndex size() const override { return S_.size(); }

  Field apply(const FieldView& radiosity) const override {
    // H_i = (sum_j S_ij B_j + d_i B_i) / A_i
    return (multiply(S_, radiosity) + radiosity.colwise() * remainder_.array()).colwise() / area_.array();
  }

  Field gather(PatchRange receivers, const FieldView& radiosity) const override;
  Field shoot(PatchRange sources, const FieldView& radiosity) const override;
  Eigen::MatrixXd form_factors(PatchRange from, PatchRange to) const override;
  Sweep sweep(Sweep from, const Relax& there, const Relax& back) const override;

 private:
  PatchRange range_of(PatchIndex I) const { return {I * tile_edge, std::min(size(), (I + 1) * tile_edge)}; }
  Field gather_row(PatchIndex I, const PackedField& b, PackedField* pushed = nullptr) const;
  Field irradiance_of(PatchIndex I, const Field& sum, const PackedField& b) const;
  void relax_block(PatchIndex I, const Field& irradiance, const Relax& relax, PackedField& b) const;

  ExchangeAreas S_;
  Eigen::VectorXd remainder_;
  Eigen::VectorXd area_;
};

// sum_j S_ij B_j for the patches i of block I, over the patches j of this block and all later ones. Where `pushed` is
// given, adds to it what the patches of block I - 1 send to those of the same blocks: the threads meet once per block
// row.
Field DenseTransport::gather_row(PatchIndex I, const PackedField& b, PackedField* pushed) const {
  const PatchIndex count = Tiles::blocks(S_) - I;
  PackedField partial(stripes, b.bands);
  parallel_for(stripes, [&](std::size_t stripe) {
    RowSums sums(b.bands);
    for (PatchIndex J = I + first_of(stripe, count); J < I + first_of(stripe + 1, count); ++J) {
      if (pushed != nullptr) push_tile(Tiles::of(S_, I - 1, J).data(), b.bands, b.block(I - 1), pushed->block(J));
      gather_tile(Tiles::of(S_, I, J).data(), b.bands, b.block(J), sums.lanes.data());
    }
    add_sums(sums, b.bands, partial.block(static_cast<PatchIndex>(stripe)));
  });
  const PatchRange range = range_of(I);
  return summed(std::move(partial), stripes).rows(0, range.end - range.begin);
}

// H_i = (sum + d_i B_i) / A_i for the patches of block I.
Field DenseTransport::irradiance_of(PatchIndex I, const Field& sum, const PackedField& b) const {
  const PatchRange range = range_of(I);
  const Eigen::Index rows = range.end - range.begin;
  const Field own = b.rows(range.begin, rows).colwise() * remainder_.segment(range.begin, rows).array();
  return (sum + own).colwise() / area_.segment(range.begin, rows).array();
}

void DenseTransport::relax_block(PatchIndex I, const Field& irradiance, const Relax& relax, PackedField& b) const {
  const PatchRange range = range_of(I);
  b.set_rows(range.begin,
             relax({range, b.rows(range.begin, irradiance.rows()), irradiance, form_factors(range, range)}));
}

// Processes block rows in order: gathers from the later blocks, relaxes, and pushes the new radiosities to them while
// the tiles are in the cache. The sums pushed to earlier blocks, by current radiosities, give the next sweep their F B
// without another pass.
Sweep DenseTransport::sweep(Sweep from, const Relax& there, const Relax& back) const {
  PackedField b(from.radiosity, Tiles::blocks(S_));
  PackedField pushed(Tiles::blocks(S_), b.bands);
  Field irradiance(from.from_earlier.rows(), from.from_earlier.cols());
  Field later = gather_row(0, b);
  for (PatchIndex I = 0; I < Tiles::blocks(S_); ++I) {
    const PatchRange range = range_of(I);
    const Eigen::Index rows = range.end - range.begin;
    if (irradiance.size() > 0) {
      const Field sum = from.from_earlier.middleRows(range.begin, rows) + later;
      irradiance.middleRows(range.begin, rows) = irradiance_of(I, sum, b);
    }
    relax_block(I, irradiance_of(I, pushed.rows(range.begin, rows) + later, b), there, b);
    if (I + 1 < Tiles::blocks(S_)) later = gather_row(I + 1, b, &pushed);
  }
  if (!back) return {b.rows(0, size()), std::move(irradiance), pushed.rows(0, size())};

  for (PatchIndex I = Tiles::blocks(S_); I-- > 0;) {
    const PatchRange range = range_of(I);
    const Field sum = pushed.rows(range.begin, range.end - range.begin) + gather_row(I, b);
    relax_block(I, irradiance_of(I, sum, b), back, b);
  }
  return {b.rows(0, size()), {}, {}};
}

Field DenseTransport::gather(PatchRange receivers, const FieldView& radiosity) const {
  assert(receivers.begin <= receivers.end && receivers.end <= size());
  const PatchIndex first = receivers.begin / tile_edge;
  const PatchIndex blocks = receivers.begin < receivers.end ? (receivers.end - 1) / tile_edge + 1 - first : 0;
  const PackedField b(radiosity, Tiles::blocks(S_));
  PackedField sum(blocks, b.bands);
  parallel_for(blocks, [&](std::size_t block) {
    const PatchIndex I = first + static_cast<PatchIndex>(block);
    double* const out = sum.block(static_cast<PatchIndex>(block));
    RowSums sums(b.bands);
    for (PatchIndex J = 0; J < Tiles::blocks(S_); ++J) {
      if (I <= J) {
        gather_tile(Tiles::of(S_, I, J).data(), b.bands, b.block(J), sums.lanes.data());
      } else {
        push_tile(Tiles::of(S_, J, I).data(), b.bands, b.block(J), out);
      }
    }
    add_sums(sums, b.bands, out);
  });
  const Eigen::Index rows = receivers.end - receivers.begin;
  const Field own =
      radiosity.middleRows(receivers.begin, rows).colwise() * remainder_.segment(receivers.begin, rows).array();
  return (sum.rows(receivers.begin % tile_edge, rows) + own).colwise() / area_.segment(receivers.begin, rows).array();
}

Field DenseTransport::shoot(PatchRange sources, const FieldView& radiosity) const {
  assert(sources.begin <= sources.end && sources.end <= size());
  Field irradiance = Field::Zero(size(), radiosity.cols());
  parallel_for(Tiles::blocks(S_), [&](std::size_t block) {
    const auto I = static_cast<PatchIndex>(block);
    const PatchIndex end = std::min(S_.size(), (I + 1) * tile_edge);
    for (PatchIndex j = sources.begin; j < sources.end; ++j) {
      const PatchIndex J = j / tile_edge;
      const std::span<const float> tile = I <= J ? Tiles::of(S_, I, J) : Tiles::of(S_, J, I);
      const std::size_t first = I <= J ? j % tile_edge : static_cast<std::size_t>(j % tile_edge) * tile_edge;
      const std::size_t step = I <= J ? tile_edge : 1;
      for (PatchIndex i = I * tile_edge; i < end; ++i) {
        irradiance.row(i) +=
            static_cast<double>(tile[first + step * (i % tile_edge)]) * radiosity.row(j - sources.begin);
      }
    }
  });
  for (PatchIndex j = sources.begin; j < sources.end; ++j) {
    irradiance.row(j) += remainder_[j] * radiosity.row(j - sources.begin);
  }
  return irradiance.colwise() / area_.array();
}

Eigen::MatrixXd DenseTransport::form_factors(PatchRange from, PatchRange to) const {
  Eigen::MatrixXd F(from.end - from.begin, to.end - to.begin);
  for (PatchIndex i = from.begin; i < from.end; ++i) {
    for (PatchIndex j = to.begin; j < to.end; ++j) {
      F(i - from.begin, j - to.begin) = static_cast<double>(S_.at(i, j)) / area_[i];
    }
  }
  return F;
}

}  // namespace

std::unique_ptr<RowTransport> dense_transport(ClosedExchangeAreas exchange_areas, Eigen::VectorXd area) {
  return std::make_unique<DenseTransport>(std::move(exchange_areas), std::move(area));
}

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

// S_ij of these patches i with all patches j, in m^2. Patches of one cluster are computed together. The cluster with
// the lower number comes first in a pair, as in the whole matrix, because rounding depends on the order.
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

// Calls use(i, row of i) in order for these patches. Rows found together look once at a cluster for several patches.
template <typename Use>
void OnDemandTransport::for_rows(PatchRange patches, Use use) const {
  for (PatchIndex begin = patches.begin; begin < patches.end; begin += tile_edge) {
    const PatchRange some{begin, std::min(begin + tile_edge, patches.end)};
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
