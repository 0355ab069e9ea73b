#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Carries out `patchlight convergence`. \throws InputError, OutputError, MemoryError, Cancelled.
ExitCode study(const StudyArguments& arguments);

}  // namespace patchlight::cli
