#pragma once

#include "lighting/direct_irradiance.h"
#include "pipeline/lit_problem.h"
#include "transport/ray_exchange.h"
#include "transport/ray_transport.h"

#include <array>
#include <vector>

namespace patchlight {

/// Rows of rays, and the light of lamps, which is found apart from them: from a small bright source a row of some rays
/// would tell little, and smoothing would blur its shadows.
struct RayLight {
  LitProblem lit;                      ///< the problem as lit_problem() has it: with all that patches emit
  std::vector<std::uint8_t> is_apart;  ///< per patch: what it emits counts in by_lamps, not in rows
  std::array<Field, 2> by_lamps;       ///< irradiance straight from them, by both halves of the samples, W/m^2
  Field lamp_standard_error;           ///< of its mean, W/m^2
  DirectIrradiance in_mirrors;  ///< what the same lamps send over mirrors and clear faces; empty where there are none
  std::vector<float> distance;  ///< as TracedRows has it
  std::vector<std::uint8_t>
      is_missed;              ///< per patch: bright, but rows that are known have sent no ray there on purpose
  double rays_per_patch = 0;  ///< mean number over the hemisphere
};

struct RayTransportAndLight {
  TracedRows rows;
  RayLight light;
};

/// Lamps are apart where they emit more than four times the mean over all patches, the strongest first, up to sixteen
/// triangles and convex quadrilaterals: what all surfaces emit alike, and the light of many lamps, stays in the rows,
/// which send rays towards bright patches on purpose. By Steps::ray_exchange where it is given; lamps that it does
/// not know are found apart as well, by shadow rays. \throws Cancelled; InputError when these are too many.
RayTransportAndLight ray_light(const Run& run, const Plan& plan, const PatchMesh& mesh);

/// Rows and lamps alone, as ray_light() traces them, to be used again. \throws Cancelled.
RayExchange trace_ray_exchange(const Run& run, const Plan& plan, const PatchMesh& mesh);

/// A solution by rows of rays, and the standard error of its irradiance, W/m^2.
struct RaySolution {
  Solution solution;
  Field standard_error;
};

/// Solves B = E + rho o (F B + H_direct) with lamps apart and all flux kept (ConservedFlux), gathers once more by each
/// half of the rays, and smooths what comes from other patches: docs/theory.md section 12. What the halves differ tells
/// the error, with the bias of smoothing and what errors of single rows do to the level of the light. `row_sum` is the
/// share of its hemisphere in which each patch sees others. \throws Cancelled; InputError for solvers that rows of rays
/// cannot serve.
RaySolution solve_with_rays(const Run& run, const PatchMesh& mesh, const RayTransport& transport, const RayLight& light,
                            const Eigen::VectorXd& row_sum, const SolverOptions& options);

}  // namespace patchlight
