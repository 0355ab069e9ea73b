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

/// Irradiance straight from the patches that emit, F E, by their rows alone. W/m^2. \throws Cancelled.
Field irradiance_by_lamps(const RowTransport& transport, const FieldView& exitance, Stage stage,
                          const Observer& observer);

/// `solve`, or when interreflection is left out the light that comes straight from the lamps: H = F E + H_direct, and
/// B = E + rho o H, in which nothing has been reflected twice.
SolveWith solver_as_planned(SolveWith solve, const Plan& plan);

/// The solution of B = E + rho o (F B + H_direct) on a mesh, and where the light went. By the solver's relative error
/// of the mesh's plan, or by less where solve_for_interest() finds that it takes less: Simulation::plan tells which was
/// asked for at last. \throws Cancelled.
Simulation solved(const Run& run, const MeshToSolve& meshed, const MeshTransport& transport, LitProblem problem);

}  // namespace patchlight
