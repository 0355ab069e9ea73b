#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/plan/plan.h"
#include "patchlight/simulate.h"
#include "patchlight/transport/transport_operator.h"

#include "pipeline/mesh_transport.h"
#include "pipeline/problem_of.h"
#include "pipeline/run.h"

namespace patchlight {

/// Returns `solve`, or without interreflection a function for direct light only: H = F E + H_direct and B = E + rho o
/// H.
SolveWith solver_as_planned(SolveWith solve, const Plan& plan);

/// The solution of B = E + rho o (F B + H_direct) on a mesh, and its light balance. The solver's relative error is that
/// of the mesh's plan, or a smaller one from solve_for_interest(). Simulation::plan records the last one. \throws
/// Canceled.
Simulation solved(const Run& run, const MeshToSolve& meshed, const MeshTransport& transport, LitProblem problem);

}  // namespace patchlight
