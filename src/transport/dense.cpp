#include "patchlight/transport/dense.h"

#include "patchlight/base/parallel.h"

#include "base/target_clones.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

constexpr PatchIndex edge = ExchangeAreas::edge;

// Partial sums of a gather are kept per stripe of source blocks, a fixed number.
constexpr std::size_t stripes = 8;

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

 private:
  // Adds the sum over the patches j of block J of S_ij B_j to the receivers' rows of `sum`.
  void gather_block(PatchRange receivers, PatchIndex J, const FieldView& radiosity, Field& sum) const;

  ExchangeAreas S_;
  Eigen::VectorXd remainder_;
  Eigen::VectorXd area_;
};

// out += T b, with T a tile or, for one left of the diagonal, its transpose. Loops become vector instructions.
PATCHLIGHT_TARGET_CLONES
void gather_tile(const float* tile, bool transposed, const double* b, double* out) {
  for (std::size_t r = 0; r < edge; ++r) {
    const float* const row = tile + r * edge;
    if (transposed) {
      for (std::size_t c = 0; c < edge; ++c) out[c] += static_cast<double>(row[c]) * b[r];
      continue;
    }
    std::array<double, 16> sum{};
    for (std::size_t c = 0; c < edge; c += 16) {
      for (std::size_t k = 0; k < 16; ++k) sum[k] += static_cast<double>(row[c + k]) * b[c + k];
    }
    out[r] += std::accumulate(sum.begin(), sum.end(), 0.0);
  }
}

void DenseTransport::gather_block(PatchRange receivers, PatchIndex J, const FieldView& radiosity, Field& sum) const {
  const Eigen::Index first = static_cast<Eigen::Index>(J) * edge;
  const Eigen::Index columns = std::min<Eigen::Index>(edge, size() - first);
  for (PatchIndex I = receivers.begin / edge; I * edge < receivers.end; ++I) {
    const std::span<const float> tile = I <= J ? S_.tile(I, J) : S_.tile(J, I);
    // The receivers' rows of this tile.
    const Eigen::Index from = std::max<Eigen::Index>(receivers.begin, static_cast<Eigen::Index>(I) * edge);
    const Eigen::Index to = std::min<Eigen::Index>(receivers.end, static_cast<Eigen::Index>(I + 1) * edge);
    for (Eigen::Index band = 0; band < radiosity.cols(); ++band) {
      Eigen::Matrix<double, edge, 1> b = Eigen::Matrix<double, edge, 1>::Zero();
      Eigen::Matrix<double, edge, 1> out = Eigen::Matrix<double, edge, 1>::Zero();
      b.head(columns) = radiosity.col(band).segment(first, columns).matrix();
      gather_tile(tile.data(), I > J, b.data(), out.data());
      sum.col(band).segment(from - receivers.begin, to - from) += out.segment(from % edge, to - from).array();
    }
  }
}

Field DenseTransport::gather(PatchRange receivers, const FieldView& radiosity) const {
  assert(receivers.begin <= receivers.end && receivers.end <= size());
  const Eigen::Index rows = receivers.end - receivers.begin;
  std::vector<Field> partial(stripes, Field::Zero(rows, radiosity.cols()));
  parallel_for(stripes, [&](std::size_t stripe) {
    for (auto J = static_cast<PatchIndex>(stripe); J < S_.blocks(); J += stripes) {
      gather_block(receivers, J, radiosity, partial[stripe]);
    }
  });
  Field sum = radiosity.middleRows(receivers.begin, rows).colwise() * remainder_.segment(receivers.begin, rows).array();
  for (const Field& part : partial) sum += part;
  return sum.colwise() / area_.segment(receivers.begin, rows).array();
}

Field DenseTransport::shoot(PatchRange sources, const FieldView& radiosity) const {
  assert(sources.begin <= sources.end && sources.end <= size());
  Field irradiance = Field::Zero(size(), radiosity.cols());
  parallel_for(S_.blocks(), [&](std::size_t block) {
    const auto I = static_cast<PatchIndex>(block);
    const PatchIndex end = std::min(S_.size(), (I + 1) * edge);
    for (PatchIndex j = sources.begin; j < sources.end; ++j) {
      const PatchIndex J = j / edge;
      const std::span<const float> tile = I <= J ? S_.tile(I, J) : S_.tile(J, I);
      const std::size_t first = I <= J ? j % edge : static_cast<std::size_t>(j % edge) * edge;
      const std::size_t step = I <= J ? edge : 1;
      for (PatchIndex i = I * edge; i < end; ++i) {
        irradiance.row(i) += static_cast<double>(tile[first + step * (i % edge)]) * radiosity.row(j - sources.begin);
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
