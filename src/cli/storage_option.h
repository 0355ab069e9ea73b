#pragma once

#include "patchlight/plan/plan.h"

#include <CLI/App.hpp>

namespace patchlight::cli {

/// Adds --method and --rays. What is parsed lands in `request`, which must outlive the command.
void add_storage_options(CLI::App& command, Request& request);

/// --method pairs|rays and --rays, of form factors that are kept for good.
void add_stored_options(CLI::App& command, Request& request);

/// Where no solver is asked for, one that can do with the storage; where one is that rows of rays do not serve, pairs
/// unless another storage is asked for.
Request with_fitting_solver(Request request, bool solver_given);

}  // namespace patchlight::cli
