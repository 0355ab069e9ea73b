#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Runs `patchlight solve`: reads, solves, and writes all results at the end, each of them whole.
/// \throws InputError, OutputError, MemoryError, Cancelled.
ExitCode solve(const SolveArguments& arguments);

}  // namespace patchlight::cli
