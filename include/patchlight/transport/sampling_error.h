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
inline constexpr std::size_t sampling_efforts = 6;  ///< how many values it takes

/// How far the sampled entries of a matrix of exchange areas are off, found from a random share of the pairs that are
/// sampled a second time. Variances are relative to the square of the unoccluded exchange area U, and pooled over pairs
/// with as many samples and about the same visible share, as the spread of one pair's samples alone tells too little.
/// In a pool a pair counts by the square of its form factor, so that the summed variances of entries, which make that
/// of a row, are right.
struct SamplingError {
  static constexpr std::size_t bins = 8;  ///< of the visible share, from 0 to 1

  /// Pairs whose rays disagreed: by the logarithm of their effort, and by their visible share.
  std::array<std::array<AuditedPairs, bins>, sampling_efforts> partial{};

  /// Pairs whose rays agreed: they count as fully visible, or as fully occluded.
  struct Unanimous {
    static constexpr std::size_t steps = 64;
    std::array<AuditedPairs, sampling_efforts> audited{};  ///< by the logarithm of their effort
    std::uint64_t missed = 0;                              ///< those where not all of the second rays agreed with these
    std::array<std::uint64_t, steps> by_share{};  ///< how many by the difference of both estimates over U, from 0 to 1

    std::uint64_t pairs() const;
  };
  Unanimous visible;
  Unanimous occluded;

  SamplingError& operator+=(const SamplingError& other);
};

/// True when some pair was sampled a second time, so that there is something to tell.
bool was_audited(const SamplingError& error);

/// How many times the usual number of samples a pair takes: the form factor without occluders, from the smaller patch,
/// over 1/4096, rounded up to a power of two, 1 to 32. For a given number of rays the error of a row is smallest when
/// each pair gets rays in proportion to its form factor.
std::uint32_t sampling_effort(double form_factor);

/// Index of an effort among them: its binary logarithm.
std::size_t effort_index(std::uint32_t effort);

/// The pairs whose rays disagreed with about this visible share, whatever their effort.
AuditedPairs with_visible_share(const SamplingError& error, std::size_t bin);

/// Standard error of an entry whose rays disagreed, as a share of U, when it took `effort` times the usual number of
/// samples. Where fewer than 30 pairs of that kind were sampled again it is that of all pairs with this effort, or of
/// all at all, whose variances are taken to fall as one over the samples.
double standard_error(const SamplingError& error, double visible_share, std::uint32_t effort = 1);

/// The same of entries whose rays agreed; 0 when none was sampled again.
double standard_error(const SamplingError::Unanimous& unanimous, std::uint32_t effort = 1);

/// An upper bound, about 95 % sure for a pair chosen at random, of what rays that agreed have wrong, as a share of
/// U: what 97 % of the pairs that were sampled again stayed below. 1 when fewer than 100 were.
double bound_on_miss(const SamplingError::Unanimous& unanimous);

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
  /// Copies the entry of the same two patches in `other`.
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
