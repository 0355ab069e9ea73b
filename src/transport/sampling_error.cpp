#include "patchlight/transport/sampling_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patchlight {

SamplingError& SamplingError::operator+=(const SamplingError& other) {
  for (std::size_t bin = 0; bin < bins; ++bin) {
    partial_pairs[bin] += other.partial_pairs[bin];
    squares[bin] += other.squares[bin];
  }
  for (const auto kind : {&SamplingError::visible, &SamplingError::occluded}) {
    (this->*kind).pairs += (other.*kind).pairs;
    (this->*kind).missed += (other.*kind).missed;
    (this->*kind).squares += (other.*kind).squares;
    for (std::size_t step = 0; step < Unanimous::steps; ++step) {
      (this->*kind).by_share[step] += (other.*kind).by_share[step];
    }
  }
  return *this;
}

bool was_audited(const SamplingError& error) {
  return std::accumulate(error.partial_pairs.begin(), error.partial_pairs.end(),
                         error.visible.pairs + error.occluded.pairs) > 0;
}

std::uint32_t sampling_effort(double form_factor) {
  constexpr double large = 1.0 / 256;
  return form_factor > 4 * large ? 16 : form_factor > large ? 4 : 1;
}

double standard_error(const SamplingError& error, double visible_share, std::uint32_t effort) {
  constexpr std::uint64_t enough = 30;
  const auto bin = static_cast<std::size_t>(
      std::clamp(visible_share * SamplingError::bins, 0.0, static_cast<double>(SamplingError::bins - 1)));
  double square = error.squares[bin];
  std::uint64_t pairs = error.partial_pairs[bin];
  if (pairs < enough) {
    square = std::accumulate(error.squares.begin(), error.squares.end(), 0.0);
    pairs = std::accumulate(error.partial_pairs.begin(), error.partial_pairs.end(), std::uint64_t{0});
  }
  return pairs > 0 ? std::sqrt(square / static_cast<double>(pairs) / effort) : 1;
}

double standard_error(const SamplingError::Unanimous& unanimous, std::uint32_t effort) {
  if (unanimous.pairs == 0) return 0;
  return std::sqrt(unanimous.squares / static_cast<double>(unanimous.pairs) / effort);
}

double bound_on_miss(const SamplingError::Unanimous& unanimous) {
  constexpr std::uint64_t enough = 100;
  constexpr double sure = 0.97;
  if (unanimous.pairs < enough) return 1;
  std::uint64_t below = 0;
  std::size_t step = 0;
  while (step < SamplingError::Unanimous::steps &&
         static_cast<double>(below) < sure * static_cast<double>(unanimous.pairs)) {
    below += unanimous.by_share[step++];
  }
  return static_cast<double>(step) / SamplingError::Unanimous::steps;
}

}  // namespace patchlight
