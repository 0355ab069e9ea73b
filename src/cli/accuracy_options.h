#pragma once

#include "patchlight/plan/plan.h"

#include <CLI/App.hpp>
#include <string>

namespace patchlight::cli {

/// Adds --accuracy, --time, --interest and --error-bars. What is parsed lands in `request`, which must outlive the
/// command.
void add_accuracy_options(CLI::App& command, Request& request);

/// Error bars take the closed matrix of the automatic estimator, made here; `form_factors` is the folder of known ones.
/// \throws UsageError when other options leave no such matrix, or --interest has nothing to act on.
void require_error_bars_possible(const Request& request, const std::string& form_factors);

}  // namespace patchlight::cli
