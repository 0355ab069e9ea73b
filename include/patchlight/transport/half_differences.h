#pragma once

#include "patchlight/transport/exchange_areas.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// The largest sampling_effort().
inline constexpr std::uint32_t most_effort = 32;

/// The multiple of the usual number of samples that a pair gets: its unoccluded form factor from the smaller patch over
/// 1/4096, rounded up to a power of two, 1 to 32. For a given number of rays the error of a row is smallest when rays
/// are proportional to form factors.
std::uint32_t sampling_effort(double form_factor);

/// The sampling errors of a symmetric matrix of exchange areas. An entry is the mean of the estimates S_1 and S_2 by
/// the two halves of its samples. Half of their difference, D = (S_1 - S_2) / 2, has the expectation 0. In
/// practice its variance is no less than that of the entry, as the second half fills the gaps of the first. So D is a
/// random draw of the error: docs/theory/occluded-form-factors.md. One byte per pair, size()^2 / 2 in all: the sign and
/// the logarithm in quarters of an octave, accurate to 9 %. Differences below 3e-10 of the geometric mean of the two
/// patches' areas become 0.
class HalfDifferences {
 public:
  HalfDifferences() = default;
  /// All are 0. `area` of each patch in m^2.
  explicit HalfDifferences(std::span<const double> area);
  /// Restores codes() for patches with these areas; there must be one for each pair.
  HalfDifferences(std::span<const double> area, std::span<const std::int8_t> codes);

  /// Number of patches; 0 when nothing is stored.
  PatchIndex size() const { return static_cast<PatchIndex>(root_of_area_.size()); }
  /// D of the exchange area S_ij, m^2; 0 without samples.
  double at(PatchIndex i, PatchIndex j) const;
  /// Different pairs may be set by different threads at once.
  void set(PatchIndex i, PatchIndex j, double difference);
  /// Copies the entry of the same two patches in `other`.
  void copy(PatchIndex i, PatchIndex j, const HalfDifferences& other, std::array<PatchIndex, 2> there);
  /// A byte for each pair i < j, at j (j - 1) / 2 + i: k stands for sign(k) sqrt(A_i A_j) 2^((|k| - 127) / 4), and 0
  /// for 0.
  std::span<const std::int8_t> codes() const { return codes_; }

 private:
  std::vector<double> root_of_area_;
  std::vector<std::int8_t> codes_;
};

}  // namespace patchlight
