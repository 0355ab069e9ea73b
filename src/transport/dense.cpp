#include "patchlight/transport/dense.h"

#include "patchlight/base/parallel.h"

#include <algorithm>
#include <cassert>
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
  // Adds sum over the patches j of block J of S_ij B_j to the receivers' rows of `sum`.
  void gather_block(PatchRange receivers, PatchIndex J, const FieldView& radiosity, Field& sum) const;

  ExchangeAreas S_;
  Eigen::VectorXd remainder_;
  Eigen::VectorXd area_;
};

void DenseTransport::gather_block(PatchRange receivers, PatchIndex J, const FieldView& radiosity, Field& sum) const {
  const PatchIndex end = std::min(S_.size(), (J + 1) * edge);
  for (PatchIndex i = receivers.begin; i < receivers.end; ++i) {
    const PatchIndex I = i / edge;
    // The row of a tile right of the diagonal, the column of one left of it.
    const std::span<const float> tile = I <= J ? S_.tile(I, J) : S_.tile(J, I);
    const std::size_t first = I <= J ? static_cast<std::size_t>(i % edge) * edge : i % edge;
    const std::size_t step = I <= J ? 1 : edge;
    for (PatchIndex j = J * edge; j < end; ++j) {
      const auto entry = static_cast<double>(tile[first + step * (j % edge)]);
      for (Eigen::Index band = 0; band < radiosity.cols(); ++band) {
        sum(i - receivers.begin, band) += entry * radiosity(j, band);
      }
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
