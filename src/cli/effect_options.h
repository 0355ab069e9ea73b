#pragma once

#include "patchlight/plan/plan.h"

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace patchlight::cli {

/// All effects that a command can enable or disable but these. Closure has an option of its own, --no-closure.
std::vector<Effect> effects_but(const std::vector<Effect>& without);

/// Adds --enable and --disable for these effects. What is parsed lands in `request`, which must outlive the command.
void add_effect_options(CLI::App& command, Request& request, const std::vector<Effect>& effects);

}  // namespace patchlight::cli
