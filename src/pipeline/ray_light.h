#pragma once

#include "pipeline/exchange_and_light.h"
#include "solve/pockets.h"

#include <vector>

namespace patchlight {

struct RayTransportAndLight {
  TracedRows rows;
  RayLight light;
};

/// Rows and light in the colour of a run, as means over what is exposed of each patch.
RayTransportAndLight ray_light(const Run& run, const PatchMesh& mesh, ExchangeAndLight found);

/// A solution by rows of rays, the standard error of its irradiance, and the part of the error that patches have in
/// common, W/m^2.
struct RaySolution {
  Solution solution;
  Field standard_error;
  std::vector<Field> correlated_errors;  ///< Simulation::correlated_errors
};

/// Solves B = E + rho o (F B + H_direct) with lamps apart and all flux kept (ConservedFlux), gathers once more by each
/// half of the rays, and smooths the light from other patches: docs/theory/ray-method-solution.md. The error combines
/// the difference of the halves, the error of the row sums, which both halves share, the bias of smoothing, and the
/// reflections of all of these. \throws Cancelled; InputError for solvers that rows of rays cannot serve.
RaySolution solve_with_rays(const Run& run, const PatchMesh& mesh, const RaysWithPockets& transport,
                            const RayLight& light, const TransportFacts& facts, const SolverOptions& options);

}  // namespace patchlight
