#pragma once

#include "cli/arguments.h"
#include "cli/exit_code.h"

namespace patchlight::cli {

/// Writes a commented scene file for models.
ExitCode new_scene(const NewArguments& arguments);

}  // namespace patchlight::cli
