#pragma once

#include "patchlight/transport/exchange_areas.h"

#include "benchmarks/room.h"

namespace patchlight::benchmarks {

/// ||B_ref - B||_A / ||B_ref - E||_A of solutions after closure, with a lamp in the middle of the ceiling.
struct SolutionErrors {
  double mixed = 0;   ///< reflectance 0.3 of what faces up, 0.8 of everything else
  double bright = 0;  ///< reflectance 0.99 everywhere
};
SolutionErrors solution_errors(const Room& room, const ExchangeAreas& S, const ExchangeAreas& reference);

}  // namespace patchlight::benchmarks
