#pragma once

#include "patchlight/plan/plan.h"

#include <CLI/App.hpp>
#include <optional>
#include <string>

namespace patchlight::cli {

/// Adds --accuracy, --time and --interest. What is parsed lands in `request`, which must outlive the command.
void add_refinement_options(CLI::App& command, Request& request);

/// The same and --error-bars.
void add_accuracy_options(CLI::App& command, Request& request);

/// What has been understood of --accuracy, in percent, for the beginning of a run; nothing without it.
std::optional<std::string> note_on_accuracy(const Request& request);

/// The option that leaves no error bars, if any: they take the closed matrix of the automatic estimator, made here.
/// `form_factors` is the folder of known ones.
std::optional<std::string> option_without_error_bars(const Request& request, const std::string& form_factors);

/// \throws UsageError when other options leave no such matrix, or --interest has nothing to act on.
void require_error_bars_possible(const Request& request, const std::string& form_factors);

}  // namespace patchlight::cli
