#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight selftest` while they are being parsed.
struct ValidateOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<ValidateOptions> add_validate(CLI::App& tool);

ValidateArguments finish_validate(const ValidateOptions& options);

}  // namespace patchlight::cli
