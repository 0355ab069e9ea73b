#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"
#include "validate/validate.h"

#include <span>

namespace patchlight::cli {

/// Runs `patchlight selftest`: a table of cases with known answers. Returns validation_failed when one of them lies
/// outside its error bar. \throws OutputError, Cancelled.
ExitCode validate(const ValidateArguments& arguments, std::span<const ValidationCase> cases);

}  // namespace patchlight::cli
