#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight compare-solvers` while they are being parsed.
struct CompareCommandOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<CompareCommandOptions> add_compare(CLI::App& tool);

/// Checks what concerns several options at once. \throws UsageError, InputError.
CompareArguments finish_compare(const CompareCommandOptions& options);

}  // namespace patchlight::cli
