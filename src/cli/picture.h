#pragma once

#include "patchlight/render/image.h"
#include "patchlight/simulate.h"

#include "cli/arguments.h"

#include <optional>

namespace patchlight::cli {

/// Radiance in W/(m^2 sr) per patch as it is shown: that of the solution, and for a solution that has not converged
/// also an estimate of the light still under way.
Field display_radiance(const Simulation& simulation);

/// The camera that the arguments ask for, else the first of the scene, in metres; nothing when there is none. \throws
/// InputError when the scene has no camera of that name.
std::optional<Camera> camera_for(const SolveArguments& arguments, const Scene& scene);

/// The picture that the arguments ask for, exposed for what it shows. \throws Cancelled.
DisplayImage make_picture(const SolveArguments& arguments, const Scene& scene, const Simulation& simulation,
                          const Occluder& occluder, const Observer& observer);

}  // namespace patchlight::cli
