#include "accuracy/needed_bands.h"

#include "solve/scattering.h"

#include <utility>

namespace patchlight {

InNeededBands in_needed_bands(const SolvedProblem& solved) {
  const RadiosityProblem& problem = solved.problem;
  SolvedBands bands =
      solved_bands({problem.scattering, source_radiosity(problem), problem.area, problem.direct_irradiance});
  RadiosityProblem needed{of_bands(problem.scattering, bands.solved), reduced(problem.exitance, bands), problem.area,
                          reduced(problem.direct_irradiance, bands)};
  Solution solution;
  solution.radiosity = reduced(solved.solution.radiosity, bands);
  solution.irradiance = reduced(solved.solution.irradiance, bands);
  return {std::move(bands), std::move(needed), std::move(solution)};
}

}  // namespace patchlight
