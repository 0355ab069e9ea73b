#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Runs `patchlight check`: tells what a model holds and what is wrong with it. Returns input_error when it cannot be
/// solved. \throws InputError, OutputError.
ExitCode check(const CheckArguments& arguments);

}  // namespace patchlight::cli
