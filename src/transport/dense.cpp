#include "transport/dense.h"

#include "base/parallel.h"
#include "transport/closure.h"
#include "transport/tile_kernel.h"
#include "transport/tiles.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace patchlight {
namespace {

// Partial sums of a gather are kept per stripe of neighbouring blocks, a fixed number.
constexpr PatchIndex gather_stripes = 8;

// The first of `count` blocks that belongs to a stripe.
PatchIndex first_of(std::size_t stripe, PatchIndex count) {
  return static_cast<PatchIndex>(stripe * count / gather_stripes);
}

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
  Field gather_row(PatchIndex I, const PackedField& b) const;
  Field push_and_gather_next(PatchIndex I, const PackedField& b, PackedField& pushed) const;
  Field irradiance_of(PatchIndex I, const Field& sum, const PackedField& b) const;
  void relax_block(PatchIndex I, const Field& irradiance, const Relax& relax, PackedField& b) const;

  ExchangeAreas S_;
  Eigen::VectorXd remainder_;
  Eigen::VectorXd area_;
};

// sum_j S_ij B_j for the patches i of block I, over the patches j of this block and all later ones.
Field DenseTransport::gather_row(PatchIndex I, const PackedField& b) const {
  const PatchIndex count = Tiles::blocks(S_) - I;
  PackedField partial(gather_stripes, b.bands);
  parallel_for(gather_stripes, [&](std::size_t stripe) {
    RowSums sums(b.bands);
    for (PatchIndex J = I + first_of(stripe, count); J < I + first_of(stripe + 1, count); ++J) {
      gather_tile(Tiles::of(S_, I, J).data(), b.bands, b.block(J), sums.lanes.data());
    }
    add_sums(sums, b.bands, partial.block(static_cast<PatchIndex>(stripe)));
  });
  const PatchRange range = range_of(I);
  return summed(std::move(partial), gather_stripes).rows(0, range.end - range.begin);
}

// Adds what the patches of block I send to those of all later blocks, and gathers for the next block: the threads meet
// once per block row.
Field DenseTransport::push_and_gather_next(PatchIndex I, const PackedField& b, PackedField& pushed) const {
  const PatchIndex next = I + 1;
  const PatchIndex count = Tiles::blocks(S_) - next;
  PackedField partial(gather_stripes, b.bands);
  parallel_for(gather_stripes, [&](std::size_t stripe) {
    RowSums sums(b.bands);
    for (PatchIndex J = next + first_of(stripe, count); J < next + first_of(stripe + 1, count); ++J) {
      push_tile(Tiles::of(S_, I, J).data(), b.bands, b.block(I), pushed.block(J));
      gather_tile(Tiles::of(S_, next, J).data(), b.bands, b.block(J), sums.lanes.data());
    }
    add_sums(sums, b.bands, partial.block(static_cast<PatchIndex>(stripe)));
  });
  if (next == Tiles::blocks(S_)) return Field(0, b.bands);
  const PatchRange range = range_of(next);
  return summed(std::move(partial), gather_stripes).rows(0, range.end - range.begin);
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

// Block row by block row: gathers from the blocks that are still to come, relaxes, and pushes the new radiosities to
// them while the tiles are in the cache. What has been pushed to a block before, with the radiosities of now, is what
// the next sweep needs to know F B of them without another pass.
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
    later = push_and_gather_next(I, b, pushed);
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

}  // namespace patchlight
