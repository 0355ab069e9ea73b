#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight relight` while they are being parsed.
struct RelightOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<RelightOptions> add_relight(CLI::App& tool);

/// Checks what concerns several options at once. What is asked for is a solve without a model. \throws UsageError,
/// InputError.
SolveArguments finish_relight(const RelightOptions& options);

}  // namespace patchlight::cli
