#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

struct NewOptions;

/// Adds the command `new`.
std::shared_ptr<NewOptions> add_new(CLI::App& tool);

/// \throws UsageError.
NewArguments finish_new(const NewOptions& options);

}  // namespace patchlight::cli
