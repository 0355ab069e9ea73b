#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight convergence` while they are being parsed.
struct StudyCommandOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<StudyCommandOptions> add_study(CLI::App& tool);

/// Checks what concerns several options at once. \throws UsageError, InputError.
StudyArguments finish_study(const StudyCommandOptions& options);

}  // namespace patchlight::cli
