#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight plan` while they are being parsed.
struct PlanOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<PlanOptions> add_plan(CLI::App& tool);

/// Checks what concerns several options at once. \throws UsageError, InputError.
PlanArguments finish_plan(const PlanOptions& options);

}  // namespace patchlight::cli
