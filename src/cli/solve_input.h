#pragma once

#include "patchlight/simulate.h"

#include "cli/arguments.h"

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

}  // namespace patchlight::cli
