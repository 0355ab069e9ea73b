#pragma once

#include "patchlight/plan/plan.h"

#include <CLI/App.hpp>
#include <optional>
#include <string>

namespace patchlight::cli {

/// Adds --accuracy, --time-limit and --focus. What is parsed lands in `request`, which must outlive the command.
void add_refinement_options(CLI::App& command, Request& request);

/// The same, --error-bars and --no-error-bars; without either of these there are cheap ones.
void add_accuracy_options(CLI::App& command, Request& request);

/// What has been understood of --accuracy, in percent, for the beginning of a run; nothing without it.
std::optional<std::string> note_on_accuracy(const Request& request);

}  // namespace patchlight::cli
