#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/plan/plan.h"
#include "patchlight/simulate.h"
#include "patchlight/transport/transport_operator.h"

namespace patchlight {

/// Irradiance straight from the patches that emit, F E, by their rows alone. W/m^2. \throws Cancelled.
Field irradiance_by_lamps(const RowTransport& transport, const FieldView& exitance, Stage stage,
                          const Observer& observer);

/// `solve`, or when interreflection is left out the light that comes straight from the lamps: H = F E + H_direct, and
/// B = E + rho o H, in which nothing has been reflected twice.
SolveWith solver_as_planned(SolveWith solve, const Plan& plan);

}  // namespace patchlight
