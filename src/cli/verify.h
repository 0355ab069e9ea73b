#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Carries out `patchlight crosscheck`: solves, traces paths, prints where they differ most. Returns validation_failed
/// when they disagree. \throws InputError, OutputError, MemoryError, Cancelled.
ExitCode verify(const VerifyArguments& arguments);

}  // namespace patchlight::cli
