#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Carries out `patchlight compare-solvers`. \throws InputError, OutputError, MemoryError, Cancelled.
ExitCode compare(const CompareArguments& arguments);

}  // namespace patchlight::cli
