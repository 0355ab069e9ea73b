#pragma once

#include "pipeline/exchange_and_light.h"
#include "solve/pockets.h"

namespace patchlight {

struct RayTransportAndLight {
  TracedRows rows;
  RayLight light;
};

/// Rows and light in the colour of a run, as means over what is exposed of each patch.
RayTransportAndLight ray_light(const Run& run, const PatchMesh& mesh, ExchangeAndLight found);

/// A solution by rows of rays, and the standard error of its irradiance, W/m^2.
struct RaySolution {
  Solution solution;
  Field standard_error;
};

/// Solves B = E + rho o (F B + H_direct) with lamps apart and all flux kept (ConservedFlux), gathers once more by each
/// half of the rays, and smooths what comes from other patches: docs/theory.md section 12. What the halves differ tells
/// the error, with that of the row sums, which the halves have in common, the bias of smoothing, and what errors of
/// single rows do to the level of the light. \throws Cancelled; InputError for solvers that rows of rays
/// cannot serve.
RaySolution solve_with_rays(const Run& run, const PatchMesh& mesh, const RaysWithPockets& transport,
                            const RayLight& light, const TransportFacts& facts, const SolverOptions& options);

}  // namespace patchlight
