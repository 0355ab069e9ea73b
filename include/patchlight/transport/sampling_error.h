#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace patchlight {

/// Pairs that were sampled a second time, independently.
struct AuditedPairs {
  std::uint64_t pairs = 0;
  double squares = 0;  ///< half the squared differences of both form factors: summed variances of one
  double weight = 0;   ///< summed squares of the form factors without occluders

  AuditedPairs& operator+=(const AuditedPairs& other);
  bool operator==(const AuditedPairs&) const = default;
};

/// What sampling_effort() is at most, 2^(sampling_efforts - 1).
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

}  // namespace patchlight
