#pragma once

#include "patchlight/simulate.h"

#include <nlohmann/json.hpp>
#include <vector>

namespace patchlight {

/// The relative errors that the last of the steps has reached; null without any. docs/reference/outputs/report-json.md
/// lists the keys.
nlohmann::ordered_json relative_errors(const std::vector<AccuracyStep>& steps);

/// Those of the patches inside and outside closed shells with openings, where these divide them; else null.
nlohmann::ordered_json relative_errors_by_space(const std::vector<SpaceErrors>& spaces);

/// What was refined on the way to an accuracy: an entry for each mesh. Empty without error bars.
nlohmann::ordered_json accuracy_steps(const std::vector<AccuracyStep>& steps);

}  // namespace patchlight
