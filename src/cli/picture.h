#pragma once

#include "patchlight/render/image.h"
#include "patchlight/simulate.h"

#include "cli/arguments.h"

namespace patchlight::cli {

/// Radiance in W/(m^2 sr) per patch as it is shown: that of the solution, and for a solution that has not converged
/// also an estimate of the light still under way.
Field display_radiance(const Simulation& simulation);

/// The picture that the arguments ask for, exposed for what it shows. \throws Cancelled.
DisplayImage make_picture(const SolveArguments& arguments, const Scene& scene, const Simulation& simulation,
                          const Occluder& occluder, const Observer& observer);

}  // namespace patchlight::cli
