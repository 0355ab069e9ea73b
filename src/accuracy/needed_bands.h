#pragma once

#include "accuracy/errors.h"
#include "solve/solved_bands.h"

namespace patchlight {

/// A solved problem in the bands that solved_bands() names: what is linear in the light is the same for the others, but
/// for a factor.
struct InNeededBands {
  SolvedBands bands;
  RadiosityProblem problem;
  Solution solution;  ///< without directs, ambient and error

  SolvedProblem solved() const { return {problem, solution}; }
};

InNeededBands in_needed_bands(const SolvedProblem& solved);

}  // namespace patchlight
