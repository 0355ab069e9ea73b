#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

/// The options of `patchlight form-factors` while they are being parsed.
struct FormFactorOptions;

/// Adds the sub-command to the tool. What is parsed lands in the returned value, which must outlive `tool`'s parsing.
std::shared_ptr<FormFactorOptions> add_form_factors(CLI::App& tool);

/// Checks what concerns several options at once. \throws UsageError, InputError.
FormFactorArguments finish_form_factors(const FormFactorOptions& options);

}  // namespace patchlight::cli
