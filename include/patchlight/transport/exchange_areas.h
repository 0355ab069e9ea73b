#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/large_array.h"

#include <Eigen/Core>
#include <cstddef>

namespace patchlight {

/// The symmetric matrix S_ij = A_i F_ij in m^2 of all pairs of patches, in single precision: Storage::tiles. Every pair
/// is stored once. Memory is 2 size()^2 bytes.
class ExchangeAreas {
 public:
  explicit ExchangeAreas(PatchIndex size);

  PatchIndex size() const { return size_; }
  /// S_ij = S_ji.
  float at(PatchIndex i, PatchIndex j) const;
  /// Sets S_ij = S_ji. Different pairs may be set by different threads at once.
  void set(PatchIndex i, PatchIndex j, float value);

  /// Bytes that a matrix of this size takes.
  static std::size_t bytes(PatchIndex size);

 private:
  friend struct Tiles;

  PatchIndex size_;
  LargeArray<float> entries_;
};

/// The product S B in double, all bands: (S B)_i = sum_j S_ij B_j, with the entries raised to `power` (1 or 2) first.
/// The same bits for any number of threads.
Field multiply(const ExchangeAreas& S, const FieldView& B, int power = 1);

/// Row sums sum_j S_ij in m^2.
Eigen::VectorXd row_sums(const ExchangeAreas& S);

}  // namespace patchlight
