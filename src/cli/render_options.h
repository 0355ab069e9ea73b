#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <memory>

namespace patchlight::cli {

struct RenderOptionsGiven;

/// Adds the sub-command `render`.
std::shared_ptr<RenderOptionsGiven> add_render(CLI::App& tool);

/// What was asked for. \throws UsageError.
RenderArguments finish_render(const RenderOptionsGiven& options);

}  // namespace patchlight::cli
