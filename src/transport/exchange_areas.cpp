#include "patchlight/transport/exchange_areas.h"

#include "patchlight/base/parallel.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace patchlight {
namespace {

constexpr PatchIndex edge = ExchangeAreas::edge;

// Partial sums are kept per stripe of block rows; their number is fixed, so that the bits do not depend on the threads.
constexpr std::size_t stripes = 16;

// Bands side by side in rows padded to whole tiles.
using Bands = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// out_I += T b_J and, for J > I, out_J += T^T b_I for one band.
void multiply_tile(std::span<const float> tile, bool diagonal, const double* b_I, const double* b_J, double* out_I,
                   double* out_J) {
  for (std::size_t r = 0; r < edge; ++r) {
    const float* row = &tile[r * edge];
    std::array<double, 8> sum{};
    for (std::size_t c = 0; c < edge; c += 8) {
      for (std::size_t k = 0; k < 8; ++k) sum[k] += static_cast<double>(row[c + k]) * b_J[c + k];
    }
    out_I[r] += ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
    if (diagonal) continue;
    for (std::size_t c = 0; c < edge; ++c) out_J[c] += static_cast<double>(row[c]) * b_I[r];
  }
}

void multiply_squared_tile(std::span<const float> tile, bool diagonal, const double* b_I, const double* b_J,
                           double* out_I, double* out_J) {
  std::array<float, edge * edge> squared;
  for (std::size_t k = 0; k < squared.size(); ++k) squared[k] = tile[k] * tile[k];
  multiply_tile(squared, diagonal, b_I, b_J, out_I, out_J);
}

}  // namespace

ExchangeAreas::ExchangeAreas(PatchIndex size) : size_(size), entries_(bytes(size) / sizeof(float), 0.0F) {}

std::size_t ExchangeAreas::bytes(PatchIndex size) {
  const std::size_t n = (size + edge - 1) / edge;
  return n * (n + 1) / 2 * edge * edge * sizeof(float);
}

std::size_t ExchangeAreas::offset(PatchIndex I, PatchIndex J) const {
  assert(I <= J && J < blocks());
  const std::size_t n = blocks();
  return (I * n - static_cast<std::size_t>(I) * (I + 1) / 2 + J) * edge * edge;
}

std::span<float> ExchangeAreas::tile(PatchIndex I, PatchIndex J) {
  return {entries_.data() + offset(I, J), static_cast<std::size_t>(edge) * edge};
}

std::span<const float> ExchangeAreas::tile(PatchIndex I, PatchIndex J) const {
  return {entries_.data() + offset(I, J), static_cast<std::size_t>(edge) * edge};
}

float ExchangeAreas::at(PatchIndex i, PatchIndex j) const {
  if (i / edge > j / edge) std::swap(i, j);
  return tile(i / edge, j / edge)[static_cast<std::size_t>(i % edge) * edge + j % edge];
}

void ExchangeAreas::set(PatchIndex i, PatchIndex j, float value) {
  if (i / edge > j / edge) std::swap(i, j);
  const std::span<float> entries = tile(i / edge, j / edge);
  const std::size_t r = i % edge;
  const std::size_t c = j % edge;
  entries[r * edge + c] = value;
  if (i / edge == j / edge) entries[c * edge + r] = value;
}

Field multiply(const ExchangeAreas& S, const FieldView& B, int power) {
  assert(B.rows() == static_cast<Eigen::Index>(S.size()) && (power == 1 || power == 2));
  const Eigen::Index padded = static_cast<Eigen::Index>(S.blocks()) * edge;
  Bands b = Bands::Zero(B.cols(), padded);
  b.leftCols(B.rows()) = B.matrix().transpose();

  // Stripe s takes the block rows s, s + stripes, ...: long and short rows spread evenly.
  std::vector<Bands> partial(stripes);
  parallel_for(stripes, [&](std::size_t stripe) {
    Bands& sum = partial[stripe];
    sum = Bands::Zero(B.cols(), padded);
    for (PatchIndex I = static_cast<PatchIndex>(stripe); I < S.blocks(); I += stripes) {
      for (PatchIndex J = I; J < S.blocks(); ++J) {
        const auto kernel = power == 1 ? multiply_tile : multiply_squared_tile;
        for (Eigen::Index band = 0; band < B.cols(); ++band) {
          kernel(S.tile(I, J), I == J, &b(band, I * edge), &b(band, J * edge), &sum(band, I * edge),
                 &sum(band, J * edge));
        }
      }
    }
  });
  for (std::size_t stripe = 1; stripe < stripes; ++stripe) partial[0] += partial[stripe];
  return partial[0].leftCols(B.rows()).transpose().array();
}

Eigen::VectorXd row_sums(const ExchangeAreas& S) {
  return multiply(S, Field::Ones(static_cast<Eigen::Index>(S.size()), 1)).matrix().col(0);
}

}  // namespace patchlight
