#pragma once

#include "patchlight/simulate.h"

#include "cli/arguments.h"

#include <filesystem>
#include <vector>

namespace patchlight::cli {

/// What is solved.
struct SolveInput {
  Scene scene;
  Request request;
  ExchangeOf exchange = {};         ///< reads stored form factors; empty: they are computed
  RayExchangeOf ray_exchange = {};  ///< reads stored rows of rays; empty: they are traced
};

/// Reads the scene from the models, or where there are none from the folder of form factors. Stored form factors bring
/// the options that they were made with. \throws InputError.
SolveInput read_input(const SolveArguments& arguments);

/// Adds the points of --points to the sensors of the scene. \throws InputError.
Scene with_points(Scene scene, const SolveArguments& arguments);

/// The file of the readings: the one that the arguments name, else their default where the scene has sensors. \throws
/// InputError when an output is named but nothing is to be read.
std::vector<std::filesystem::path> points_outputs(const SolveArguments& arguments, const Scene& scene);

}  // namespace patchlight::cli
