#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight solve`, in the units of the command line, while they are being parsed.
struct SolveOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<SolveOptions> add_solve(CLI::App& tool);

/// Converts units and checks what concerns several options at once. \throws UsageError, InputError.
SolveArguments finish_solve(const SolveOptions& options);

}  // namespace patchlight::cli
