#pragma once

#include "patchlight/render/image.h"
#include "patchlight/simulate.h"

#include "cli/arguments.h"

#include <optional>

namespace patchlight::cli {

/// The camera that the arguments ask for, else the first of the scene, in metres; nothing when there is none. \throws
/// InputError when the scene has no camera of that name.
std::optional<Camera> camera_for(const SolveArguments& arguments, const Scene& scene);

/// The picture that the arguments ask for, with a legend where its colours are false. \throws Cancelled.
DisplayImage make_picture(const SolveArguments& arguments, const Scene& scene, const Simulation& simulation,
                          const Observer& observer);

}  // namespace patchlight::cli
