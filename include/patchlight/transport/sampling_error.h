#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace patchlight {

/// How far the sampled entries of a matrix of exchange areas are off, found from a random share of the pairs that are
/// sampled a second time, independently. Variances are relative to the square of the unoccluded exchange area U, and
/// pooled over pairs of about the same visible share, as the spread of one pair's samples alone tells too little. Half
/// the squared difference of the two estimates is the variance of one of them, times the pair's effort that of the
/// usual number of samples.
struct SamplingError {
  static constexpr std::size_t bins = 8;  ///< of the visible share, from 0 to 1

  /// Pairs whose rays disagreed.
  std::array<std::uint64_t, bins> partial_pairs{};
  std::array<double, bins> squares{};  ///< summed variances with the usual number of samples

  /// Pairs whose rays agreed: they count as fully visible, or as fully occluded.
  struct Unanimous {
    static constexpr std::size_t steps = 64;
    std::uint64_t pairs = 0;   ///< those sampled a second time
    std::uint64_t missed = 0;  ///< of these, those where not all of the second rays agreed with these
    std::array<std::uint64_t, steps> by_share{};  ///< how many by the difference of both estimates over U, from 0 to 1
    double squares = 0;                           ///< summed variances with the usual number of samples
  };
  Unanimous visible;
  Unanimous occluded;

  SamplingError& operator+=(const SamplingError& other);
};

/// True when some pair was sampled a second time, so that there is something to tell.
bool was_audited(const SamplingError& error);

/// How many times the usual number of samples a pair takes: 1, 4 or 16, by its form factor without occluders, from the
/// smaller patch. For a given number of rays the error of a row is smallest when each pair gets rays in proportion to
/// its form factor.
std::uint32_t sampling_effort(double form_factor);

/// Standard error of an entry whose rays disagreed, as a share of U, when it took `effort` times the usual number of
/// samples; from all such pairs where fewer than 30 have about this visible share.
double standard_error(const SamplingError& error, double visible_share, std::uint32_t effort = 1);

/// The same of entries whose rays agreed; 0 when none was sampled again.
double standard_error(const SamplingError::Unanimous& unanimous, std::uint32_t effort = 1);

/// An upper bound, about 95 % sure for a pair chosen at random, of what rays that agreed have wrong, as a share of
/// U: what 97 % of the pairs that were sampled again stayed below. 1 when fewer than 100 were.
double bound_on_miss(const SamplingError::Unanimous& unanimous);

}  // namespace patchlight
