#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight crosscheck` while they are being parsed.
struct VerifyCommandOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<VerifyCommandOptions> add_verify(CLI::App& tool);

/// Checks what concerns several options at once. \throws UsageError, InputError.
VerifyArguments finish_verify(const VerifyCommandOptions& options);

}  // namespace patchlight::cli
