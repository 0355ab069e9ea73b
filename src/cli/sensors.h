#pragma once

#include "patchlight/scene/scene.h"

#include "cli/arguments.h"

#include <filesystem>
#include <vector>

namespace patchlight::cli {

/// Adds the points of --points to the sensors of the scene. \throws InputError.
Scene with_points(Scene scene, const SolveArguments& arguments);

/// Where readings are written: what the arguments name, else their default where the scene has sensors. \throws
/// InputError when an output is named but nothing is to be read.
std::vector<std::filesystem::path> points_outputs(const SolveArguments& arguments, const Scene& scene);

}  // namespace patchlight::cli
