#pragma once

#include "patchlight/plan/plan.h"

#include <CLI/App.hpp>

namespace patchlight::cli {

/// Adds --force and --skip. What is parsed lands in `request`, which must outlive the command.
void add_effect_options(CLI::App& command, Request& request);

/// \throws UsageError when the effects that are forced and skipped contradict each other or other options of the
/// request.
void require_consistent_effects(const Request& request);

}  // namespace patchlight::cli
