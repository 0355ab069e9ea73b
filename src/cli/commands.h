#pragma once

#include "cli/arguments.h"
#include "cli/messages.h"
#include "validate/validate.h"

#include <span>

// Each function runs the command with these arguments. All may throw InputError, OutputError, MemoryError and
// `Canceled`.
namespace patchlight::cli {

/// Reports the contents of a model and its problems. Returns input_error when the model cannot be solved.
ExitCode run(const CheckArguments& arguments);

/// Writes a commented scene file for models.
ExitCode run(const InitArguments& arguments);

/// Reads, solves and writes all results at the end, each file atomically. `patchlight relight` solves without a model.
ExitCode run(const SolveArguments& arguments);

/// Renders images of a saved solution.
ExitCode run(const RenderArguments& arguments);

/// A dry run: prints the effects that would be simulated, the reasons, and the expected cost.
ExitCode run(const PlanArguments& arguments);

/// Computes a year of daylight at sensors and writes a folder.
ExitCode run(const AnnualArguments& arguments);

/// Solves, traces paths, and prints the largest differences. Returns validation_failed when they disagree.
ExitCode run(const CrosscheckArguments& arguments);

/// Writes the form factors between the patches of a model.
ExitCode run(const FormFactorArguments& arguments);

/// Solves a model with every solver.
ExitCode run(const ComparisonArguments& arguments);

/// Measures the cost of accuracy.
ExitCode run(const ConvergenceArguments& arguments);

/// Prints a table of cases with known answers. Returns validation_failed when one lies outside its error bar.
ExitCode run(const SelftestArguments& arguments, std::span<const ValidationCase> cases);

}  // namespace patchlight::cli
