#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/large_array.h"

#include <Eigen/Core>
#include <cstddef>
#include <span>

namespace patchlight {

/// The symmetric matrix S_ij = A_i F_ij in m^2 of all pairs of patches, in single precision. Stored once: square tiles
/// of `edge` x `edge` entries for block rows I <= J, row by row; a diagonal tile holds both of its halves. Rows and
/// columns beyond size() are zero. Memory is 2 size()^2 bytes.
class ExchangeAreas {
 public:
  static constexpr PatchIndex edge = 64;

  explicit ExchangeAreas(PatchIndex size);

  PatchIndex size() const { return size_; }
  /// Number of block rows.
  PatchIndex blocks() const { return (size_ + edge - 1) / edge; }
  /// The edge * edge entries of the tile in block row I and block column J >= I.
  std::span<float> tile(PatchIndex I, PatchIndex J);
  std::span<const float> tile(PatchIndex I, PatchIndex J) const;
  float at(PatchIndex i, PatchIndex j) const;
  /// Sets S_ij = S_ji. Different pairs may be set by different threads at once.
  void set(PatchIndex i, PatchIndex j, float value);

  /// Bytes that a matrix of this size takes.
  static std::size_t bytes(PatchIndex size);

 private:
  std::size_t offset(PatchIndex I, PatchIndex J) const;

  PatchIndex size_;
  LargeArray<float> entries_;
};

/// Sums S B over j for every row, all bands, in double: (S B)_i = sum_j S_ij B_j, with the entries raised to `power` (1
/// or 2) first. The same bits for any number of threads.
Field multiply(const ExchangeAreas& S, const FieldView& B, int power = 1);

/// Row sums sum_j S_ij in m^2.
Eigen::VectorXd row_sums(const ExchangeAreas& S);

}  // namespace patchlight
