#pragma once

#include "pipeline/lit_problem.h"
#include "pipeline/mesh_transport.h"
#include "pipeline/run.h"

namespace patchlight {

/// The solution of B = E + rho o (F B + H_direct) on a mesh, and where the light went. By the solver's relative error
/// of the mesh's plan, or by less where solve_for_interest() finds that it takes less: Simulation::plan tells which was
/// asked for at last. \throws Cancelled.
Simulation solved(const Run& run, const MeshToSolve& meshed, const MeshTransport& transport, LitProblem problem);

}  // namespace patchlight
