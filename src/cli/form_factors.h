#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Runs `patchlight form-factors`: writes the form factors between the patches of a model.
/// \throws InputError, OutputError, MemoryError, Cancelled.
ExitCode form_factors(const FormFactorArguments& arguments);

}  // namespace patchlight::cli
