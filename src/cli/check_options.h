#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight check` while they are being parsed.
struct CheckOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<CheckOptions> add_check(CLI::App& tool);

/// Checks what concerns several options at once. \throws UsageError, InputError.
CheckArguments finish_check(const CheckOptions& options);

}  // namespace patchlight::cli
