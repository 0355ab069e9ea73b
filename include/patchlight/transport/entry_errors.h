#pragma once

#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/sampling_error.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// How the entry of a pair was found.
enum class EntryKind {
  exact,        ///< without shadow rays
  all_visible,  ///< its shadow rays were all free: the unoccluded value
  all_hidden,   ///< they were all blocked: 0
  estimated     ///< from samples
};

/// How each entry of a symmetric matrix was found, and the standard errors of those that were estimated. One byte for
/// each pair, size()^2 / 2 in all: errors are kept as logarithms in sixths of an octave, so that one is right to 6 %,
/// as long as it is above 2.3e-13 of the geometric mean of the two patches' areas; below, that is kept.
class EntryErrors {
 public:
  EntryErrors() = default;
  /// All entries exact. `area` of each patch in m^2.
  explicit EntryErrors(std::span<const double> area);
  /// Takes codes() of patches with these areas; there must be one for each pair.
  EntryErrors(std::span<const double> area, std::vector<std::uint8_t> codes);

  /// Number of patches; 0 when nothing is kept.
  PatchIndex size() const { return static_cast<PatchIndex>(root_of_area_.size()); }
  EntryKind kind(PatchIndex i, PatchIndex j) const;
  /// That of the exchange area S_ij, m^2; 0 unless it is estimated.
  double standard_error(PatchIndex i, PatchIndex j) const;
  /// Different pairs may be set by different threads at once.
  void set(PatchIndex i, PatchIndex j, EntryKind kind, double standard_error = 0);
  /// Takes what `other` has for the same two patches.
  void copy(PatchIndex i, PatchIndex j, const EntryErrors& other, std::array<PatchIndex, 2> there);
  /// A byte for each pair i < j, at j (j - 1) / 2 + i: 0 to 2 is an EntryKind, k from 3 on an estimate with the
  /// standard error sqrt(A_i A_j) 2^((k - 255) / 6).
  std::span<const std::uint8_t> codes() const { return codes_; }

 private:
  std::vector<double> root_of_area_;
  std::vector<std::uint8_t> codes_;
};

/// The standard errors of estimated entries S_ij from the unoccluded exchange areas U_ij, which stand in `unoccluded`
/// in their place: those of `error` at the visible share S_ij / U_ij and the effort of U_ij / A, with the smaller area.
/// As both are kept in sixths of an octave, the result is right to 12 %, but where U is so near to a step of the share
/// or the effort that it falls on the wrong side.
EntryErrors with_sampling_error(EntryErrors unoccluded, const ExchangeAreas& S, const SamplingError& error,
                                std::span<const double> area);

}  // namespace patchlight
