#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Tells what a run would simulate, why, and what it would cost, without running it.
ExitCode plan(const PlanArguments& arguments);

}  // namespace patchlight::cli
