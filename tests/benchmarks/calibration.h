#pragma once

#include "patchlight/transport/assemble.h"

#include "benchmarks/room.h"
#include "benchmarks/sampled_entries.h"

#include <array>
#include <cstddef>

namespace patchlight::benchmarks {

/// How the errors of some estimates compare with their standard errors.
struct Spread {
  double pairs = 0;
  double within = 0;  ///< share of them that is off by at most 1.96 standard errors
  double rms_z = 0;   ///< root mean square of error / standard error
  double mean_z = 0;
};

/// Every pair whose rays disagreed, and those by the bins of the visible share.
struct PartialPairs {
  Spread all;
  std::array<Spread, SamplingError::bins> bins;
};
PartialPairs partial_pairs(const std::vector<SampledEntry>& sampled, const Assembly& assembly,
                           const ExchangeAreas& reference);

/// Every pair whose rays agreed.
struct UnanimousPairs {
  double pairs = 0;
  double within = 0;        ///< share of them that is off by at most the bound
  double bound = 0;         ///< stated by the audit, as a share of the unoccluded exchange area
  double audited_rate = 0;  ///< share of the audited ones where they missed something
  double rate = 0;          ///< share of all where they did, by the reference
};
UnanimousPairs unanimous_pairs(const std::vector<SampledEntry>& sampled, const Assembly& assembly,
                               const ExchangeAreas& reference, bool visible);

/// Pairs that were decided without a ray, of which some thousand are drawn and have rays traced between them.
struct DecidedPairs {
  double free = 0;          ///< pairs drawn of those that count as free
  double free_wrong = 0;    ///< of these, those with a blocked ray
  double free_error = 0;    ///< largest relative error of their exchange area, by the contour integral
  double hidden = 0;        ///< pairs drawn that face each other and count as hidden
  double hidden_wrong = 0;  ///< of these, those with a free ray
};
DecidedPairs decided_pairs(const Room& room, const Assembly& assembly);

}  // namespace patchlight::benchmarks
