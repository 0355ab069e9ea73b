#pragma once

#include "patchlight/plan/plan.h"

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace patchlight::cli {

/// Adds --force and --skip for these effects. What is parsed lands in `request`, which must outlive the command.
void add_effect_options(CLI::App& command, Request& request, const std::vector<Effect>& effects = simulated_effects());

/// All effects that a command may be asked for but these.
std::vector<Effect> effects_but(const std::vector<Effect>& without);

}  // namespace patchlight::cli
