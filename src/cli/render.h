#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Takes pictures of a solution on disk, and writes them. \throws InputError, OutputError, Cancelled.
ExitCode render(const RenderArguments& arguments);

}  // namespace patchlight::cli
