#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <functional>

namespace patchlight::cli {

/// Checks the options of a command after they were parsed, and returns the request. \throws
/// UsageError, InputError.
using Finish = std::function<Arguments()>;

/// Each adds a command with its options to the tool.
Finish add_check(CLI::App& tool);
Finish add_init(CLI::App& tool);
Finish add_solve(CLI::App& tool);
Finish add_render(CLI::App& tool);
Finish add_plan(CLI::App& tool);
Finish add_crosscheck(CLI::App& tool);
Finish add_relight(CLI::App& tool);
Finish add_form_factors(CLI::App& tool);
Finish add_compare_solvers(CLI::App& tool);
Finish add_convergence(CLI::App& tool);
Finish add_selftest(CLI::App& tool);

}  // namespace patchlight::cli
