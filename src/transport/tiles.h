#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/large_array.h"
#include "patchlight/transport/exchange_areas.h"

#include "base/parallel.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace patchlight {

/// Rows and columns of a tile.
inline constexpr PatchIndex tile_edge = 64;

/// Partial sums of products are kept per stripe of rows. The number of stripes is fixed, so the bits do not depend on
/// the number of threads.
inline constexpr PatchIndex stripes = 8;

/// The sum over all rows below `rows` of the values that add(row, sum) adds to a copy of `zero`. Stripe s has the rows
/// s, s + count, ...: long and short rows spread evenly.
template <typename Sum, typename Add>
Sum sum_over_stripes(PatchIndex rows, PatchIndex count, const Sum& zero, Add add) {
  std::vector<Sum> partial(count, zero);
  parallel_for(count, [&](std::size_t stripe) {
    for (auto row = static_cast<PatchIndex>(stripe); row < rows; row += count) add(row, partial[stripe]);
  });
  for (PatchIndex stripe = 1; stripe < count; ++stripe) partial[0] += partial[stripe];
  return std::move(partial[0]);
}

/// The layout of ExchangeAreas: square tiles of tile_edge x tile_edge entries for block rows I <= J, row by row. A
/// diagonal tile holds both of its halves; rows and columns beyond size() are zero. Only products use tiles; other code
/// uses entry_parts(), for_entries() and changed().
struct Tiles {
  /// Number of block rows.
  static PatchIndex blocks(const ExchangeAreas& S);
  /// The entries of the tile in block row I and block column J >= I.
  static std::span<float> of(ExchangeAreas& S, PatchIndex I, PatchIndex J);
  static std::span<const float> of(const ExchangeAreas& S, PatchIndex I, PatchIndex J);
};

/// The float nearest to `value` that is not farther from zero.
inline float narrow_toward_zero(double value) {
  const auto nearest = static_cast<float>(value);
  if (!(std::abs(static_cast<double>(nearest)) > std::abs(value))) return nearest;
  // The next float toward zero: one less in the bits after the sign, which order floats by their size.
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) - 1);
}

/// The number of parts in for_entries(). Every pair of patches is in exactly one.
inline PatchIndex entry_parts(const ExchangeAreas& S) { return Tiles::blocks(S); }

/// Calls use(i, j, S_ij) for the entries i < j of a part that are not 0, always in the same order.
template <typename Use>
void for_entries(const ExchangeAreas& S, PatchIndex part, Use use) {
  const PatchIndex I = part;
  for (PatchIndex J = I; J < Tiles::blocks(S); ++J) {
    const std::span<const float> tile = Tiles::of(S, I, J);
    for (PatchIndex k = 0; k < tile_edge * tile_edge; ++k) {
      const PatchIndex i = I * tile_edge + k / tile_edge;
      const PatchIndex j = J * tile_edge + k % tile_edge;
      if (i < j && tile[k] != 0) use(i, j, static_cast<double>(tile[k]));
    }
  }
}

/// Replaces every nonzero entry S_ij by value(i, j, S_ij) = value(j, i, S_ij), rounded toward zero. Several threads
/// call `value` at once.
using Change = std::function<double(PatchIndex i, PatchIndex j, double entry)>;
ExchangeAreas changed(ExchangeAreas S, const Change& value);

/// Values of all bands, arranged for the products with tiles: eight patches of one band side by side, then the next
/// band; padded with zeros to whole tiles.
struct PackedField {
  int bands = 0;
  LargeArray<double> values;

  PackedField(PatchIndex blocks, int bands_of_each);
  PackedField(const FieldView& field, PatchIndex blocks);
  /// The values of the patches of a block.
  double* block(PatchIndex I) { return values.data() + offset(I); }
  const double* block(PatchIndex I) const { return values.data() + offset(I); }
  /// Rows [begin, begin + rows).
  Field rows(Eigen::Index begin, Eigen::Index rows) const;
  void set_rows(Eigen::Index begin, const FieldView& field);

 private:
  std::size_t offset(PatchIndex I) const { return static_cast<std::size_t>(I) * tile_edge * bands; }
};

/// Sums over the tiles of a block row, in eight separate lanes for each patch and band until the row is complete.
struct RowSums {
  LargeArray<double> lanes;

  explicit RowSums(int bands);
};

/// Adds the lanes: out_I += the sums.
void add_sums(const RowSums& sums, int bands, double* out_I);

/// Products of a tile T with the packed values of one block, all bands in one pass over the tile, summed in double.
/// gather: sums_I += T b_J, with sums_I as in RowSums::lanes. push: out_J += T^T b_I.
void gather_tile(const float* tile, int bands, const double* b_J, double* sums_I);
void push_tile(const float* tile, int bands, const double* b_I, double* out_J);

/// Both at once.
struct TileProduct {
  const double* b_rows;     ///< packed values of block I
  const double* b_columns;  ///< of block J
  double* row_sums;         ///< RowSums::lanes
  double* column_sums;      ///< as out_J
};
void multiply_tile(const float* tile, int bands, const TileProduct& product);

/// The sum of `count` consecutive fields, in this order.
PackedField summed(PackedField parts, PatchIndex count);

}  // namespace patchlight
