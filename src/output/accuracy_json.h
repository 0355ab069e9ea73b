#pragma once

#include "patchlight/simulate.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// The relative errors of a simulation's error bars; null without any. docs/output.md lists the keys.
nlohmann::ordered_json relative_errors(const Simulation& simulation);

/// Those of the patches inside and outside closed shells with openings, where these divide them; else null.
nlohmann::ordered_json relative_errors_by_space(const Simulation& simulation);

/// What was refined on the way to an accuracy: an entry for each mesh. Empty without error bars.
nlohmann::ordered_json accuracy_steps(const Simulation& simulation);

}  // namespace patchlight
