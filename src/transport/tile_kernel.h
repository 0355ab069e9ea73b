#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/large_array.h"

#include "transport/tiles.h"

#include <cstddef>

namespace patchlight {

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

/// Sums over the tiles of a block row, kept apart in eight lanes for each patch and band until the row is done.
struct RowSums {
  LargeArray<double> lanes;

  explicit RowSums(int bands);
};

/// Adds the lanes up: out_I += the sums.
void add_sums(const RowSums& sums, int bands, double* out_I);

/// Products of a tile T with the packed values of one block, all bands in one pass over the tile, summed in double.
/// gather: sums_I += T b_J, with sums_I as in RowSums::lanes. push: out_J += T^T b_I.
void gather_tile(const float* tile, int bands, const double* b_J, double* sums_I);
void push_tile(const float* tile, int bands, const double* b_I, double* out_J);

/// Both at once.
struct TileProduct {
  const double* b_I;
  const double* b_J;
  double* sums_I;  ///< RowSums::lanes
  double* out_J;
};
void multiply_tile(const float* tile, int bands, const TileProduct& product);

/// The sum of `count` fields that lie one behind the other, in this order.
PackedField summed(PackedField parts, PatchIndex count);

}  // namespace patchlight
