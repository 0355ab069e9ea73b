#pragma once

#include "patchlight/transport/exchange_areas.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Pairs that were sampled a second time, independently.
struct AuditedPairs {
  std::uint64_t pairs = 0;
  double squares = 0;  ///< half the squared differences of both form factors: summed variances of one
  double weight = 0;   ///< summed squares of the form factors without occluders

  AuditedPairs& operator+=(const AuditedPairs& other);
  bool operator==(const AuditedPairs&) const = default;
};

/// The largest sampling_effort(), 2^(sampling_efforts - 1).
inline constexpr std::uint32_t most_effort = 32;
inline constexpr std::size_t sampling_efforts = 6;  ///< the number of its values

/// The sampling error of a matrix of exchange areas, from a random subset of pairs that are sampled twice. Variances
/// are relative to the square of the unoccluded exchange area U. They are pooled over pairs with the same number of
/// samples and about the same visible share, because the spread of one pair's samples is too noisy. A pair counts by
/// the square of its form factor, so that the summed variances of entries, which give that of a row, are right.
struct SamplingError {
  static constexpr std::size_t bins = 8;  ///< of the visible share, from 0 to 1

  /// Pairs whose rays disagreed: by the logarithm of their effort, and by their visible share.
  std::array<std::array<AuditedPairs, bins>, sampling_efforts> partial{};

  /// Pairs whose rays agreed: they count as fully visible, or as fully occluded.
  struct Unanimous {
    static constexpr std::size_t steps = 64;
    std::array<AuditedPairs, sampling_efforts> audited{};  ///< by the logarithm of their effort
    std::uint64_t missed = 0;                              ///< pairs where some of the second rays disagreed
    std::array<std::uint64_t, steps> by_share{};  ///< histogram of the difference of both estimates over U, from 0 to 1

    std::uint64_t pairs() const;
  };
  Unanimous visible;
  Unanimous occluded;

  SamplingError& operator+=(const SamplingError& other);
};

/// True when at least one pair was sampled a second time.
bool was_audited(const SamplingError& error);

/// The multiple of the usual number of samples that a pair gets: its unoccluded form factor from the smaller patch over
/// 1/4096, rounded up to a power of two, 1 to 32. For a given number of rays the error of a row is smallest when rays
/// are proportional to form factors.
std::uint32_t sampling_effort(double form_factor);

/// The index of an effort: its binary logarithm.
std::size_t effort_index(std::uint32_t effort);

/// The pairs whose rays disagreed, with about this visible share and any effort.
AuditedPairs with_visible_share(const SamplingError& error, std::size_t bin);

/// Standard error of an entry whose rays disagreed, as a share of U, for `effort` times the usual number of samples. If
/// fewer than 30 pairs of that kind were sampled again, it uses all pairs with this effort, or else all pairs. These
/// variances are assumed to fall as one over the number of samples.
double standard_error(const SamplingError& error, double visible_share, std::uint32_t effort = 1);

/// The same for entries whose rays agreed; 0 when none was sampled again.
double standard_error(const SamplingError::Unanimous& unanimous, std::uint32_t effort = 1);

/// An upper bound on the error of rays that agreed, as a share of U, with about 95 % confidence for a random pair. The
/// bound holds for 97 % of the pairs that were sampled again. 1 if there were fewer than 100 such pairs.
double bound_on_miss(const SamplingError::Unanimous& unanimous);

/// How the entry of a pair was computed.
enum class EntryKind {
  exact,        ///< without shadow rays
  all_visible,  ///< all shadow rays were free: the unoccluded value
  all_hidden,   ///< all shadow rays were blocked: 0
  estimated     ///< from samples
};

/// How each entry of a symmetric matrix was computed, and the standard errors of the estimated ones. One byte per pair,
/// size()^2 / 2 in all. Errors are stored as logarithms in sixths of an octave, so each is accurate to 6 %. The
/// smallest stored error is 2.3e-13 of the geometric mean of the two patches' areas.
class EntryErrors {
 public:
  EntryErrors() = default;
  /// All entries are exact. `area` of each patch in m^2.
  explicit EntryErrors(std::span<const double> area);
  /// Restores codes() for patches with these areas; there must be one for each pair.
  EntryErrors(std::span<const double> area, std::vector<std::uint8_t> codes);

  /// Number of patches; 0 when nothing is stored.
  PatchIndex size() const { return static_cast<PatchIndex>(root_of_area_.size()); }
  EntryKind kind(PatchIndex i, PatchIndex j) const;
  /// The standard error of the exchange area S_ij, m^2; 0 unless it is estimated.
  double standard_error(PatchIndex i, PatchIndex j) const;
  /// Different pairs may be set by different threads at once.
  void set(PatchIndex i, PatchIndex j, EntryKind kind, double standard_error = 0);
  /// Copies the entry of the same two patches in `other`.
  void copy(PatchIndex i, PatchIndex j, const EntryErrors& other, std::array<PatchIndex, 2> there);
  /// A byte for each pair i < j, at j (j - 1) / 2 + i: 0 to 2 is an EntryKind, k from 3 on an estimate with the
  /// standard error sqrt(A_i A_j) 2^((k - 255) / 6).
  std::span<const std::uint8_t> codes() const { return codes_; }

 private:
  std::vector<double> root_of_area_;
  std::vector<std::uint8_t> codes_;
};

/// The standard errors of estimated entries S_ij. `unoccluded` holds the unoccluded exchange areas U_ij in their place.
/// The result is that of `error` at the visible share S_ij / U_ij and the effort of U_ij / A, with the smaller area.
/// Both values are stored in sixths of an octave, so the result is accurate to 12 %. It may be worse where U is close
/// to a step of the share or the effort.
EntryErrors with_sampling_error(EntryErrors unoccluded, const ExchangeAreas& S, const SamplingError& error,
                                std::span<const double> area);

}  // namespace patchlight
