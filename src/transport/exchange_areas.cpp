#include "patchlight/transport/exchange_areas.h"

#include "base/parallel.h"
#include "transport/tiles.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace patchlight {
namespace {

// Partial sums are kept per stripe of block rows; their number is fixed, so that the bits do not depend on the threads.
constexpr PatchIndex product_stripes = 8;

// Where the tile of block row I and block column J begins among n block rows.
std::size_t first_entry(std::size_t n, PatchIndex I, PatchIndex J) {
  assert(I <= J && J < n);
  return (I * n - static_cast<std::size_t>(I) * (I + 1) / 2 + J) * tile_edge * tile_edge;
}

std::array<float, std::size_t{tile_edge} * tile_edge> squared(std::span<const float> tile) {
  std::array<float, std::size_t{tile_edge} * tile_edge> squares;
  for (std::size_t k = 0; k < squares.size(); ++k) squares[k] = tile[k] * tile[k];
  return squares;
}

// Sums that take the products of one stripe.
struct Sums {
  PackedField& field;
  PatchIndex first;  // block at which they begin
  double* block(PatchIndex I) const { return field.block(first + I); }
};

// Adds the products of the tiles of block row I with b.
void multiply_row(const ExchangeAreas& S, PatchIndex I, const PackedField& b, int power, const Sums& sum) {
  RowSums sums_I(b.bands);
  for (PatchIndex J = I; J < Tiles::blocks(S); ++J) {
    const auto multiply_with = [&](const float* tile) {
      if (I == J) return gather_tile(tile, b.bands, b.block(J), sums_I.lanes.data());
      multiply_tile(tile, b.bands, {b.block(I), b.block(J), sums_I.lanes.data(), sum.block(J)});
    };
    if (power == 1) {
      multiply_with(Tiles::of(S, I, J).data());
    } else {
      multiply_with(squared(Tiles::of(S, I, J)).data());
    }
  }
  add_sums(sums_I, b.bands, sum.block(I));
}

}  // namespace

ExchangeAreas::ExchangeAreas(PatchIndex size) : size_(size), entries_(bytes(size) / sizeof(float), 0.0F) {}

std::size_t ExchangeAreas::bytes(PatchIndex size) {
  const std::size_t n = (size + tile_edge - 1) / tile_edge;
  return n * (n + 1) / 2 * tile_edge * tile_edge * sizeof(float);
}

float ExchangeAreas::at(PatchIndex i, PatchIndex j) const {
  if (i / tile_edge > j / tile_edge) std::swap(i, j);
  const std::span<const float> entries = Tiles::of(*this, i / tile_edge, j / tile_edge);
  return entries[static_cast<std::size_t>(i % tile_edge) * tile_edge + j % tile_edge];
}

void ExchangeAreas::set(PatchIndex i, PatchIndex j, float value) {
  if (i / tile_edge > j / tile_edge) std::swap(i, j);
  const std::span<float> entries = Tiles::of(*this, i / tile_edge, j / tile_edge);
  const std::size_t r = i % tile_edge;
  const std::size_t c = j % tile_edge;
  entries[r * tile_edge + c] = value;
  if (i / tile_edge == j / tile_edge) entries[c * tile_edge + r] = value;
}

PatchIndex Tiles::blocks(const ExchangeAreas& S) { return (S.size() + tile_edge - 1) / tile_edge; }

std::span<float> Tiles::of(ExchangeAreas& S, PatchIndex I, PatchIndex J) {
  return {S.entries_.data() + first_entry(blocks(S), I, J), static_cast<std::size_t>(tile_edge) * tile_edge};
}

std::span<const float> Tiles::of(const ExchangeAreas& S, PatchIndex I, PatchIndex J) {
  return {S.entries_.data() + first_entry(blocks(S), I, J), static_cast<std::size_t>(tile_edge) * tile_edge};
}

Field multiply(const ExchangeAreas& S, const FieldView& B, int power) {
  assert(B.rows() == static_cast<Eigen::Index>(S.size()) && (power == 1 || power == 2));
  const PackedField b(B, Tiles::blocks(S));

  // Stripe s takes the block rows s, s + product_stripes, ...: long and short rows spread evenly.
  PackedField partial(product_stripes * Tiles::blocks(S), b.bands);
  parallel_for(product_stripes, [&](std::size_t stripe) {
    for (auto I = static_cast<PatchIndex>(stripe); I < Tiles::blocks(S); I += product_stripes) {
      multiply_row(S, I, b, power, {partial, static_cast<PatchIndex>(stripe) * Tiles::blocks(S)});
    }
  });
  return summed(std::move(partial), product_stripes).rows(0, B.rows());
}

Eigen::VectorXd row_sums(const ExchangeAreas& S) {
  return multiply(S, Field::Ones(static_cast<Eigen::Index>(S.size()), 1)).matrix().col(0);
}

}  // namespace patchlight
