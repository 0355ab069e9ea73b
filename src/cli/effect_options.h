#pragma once

#include "patchlight/plan/plan.h"

#include <CLI/App.hpp>
#include <string>

namespace patchlight::cli {

/// Adds --force and --skip. What is parsed lands in `request`, which must outlive the command.
void add_effect_options(CLI::App& command, Request& request);

/// `form_factors` is the folder of known ones, in which occlusion is decided. \throws UsageError when the effects that
/// are forced and skipped contradict each other or other options.
void require_consistent_effects(const Request& request, const std::string& form_factors);

}  // namespace patchlight::cli
