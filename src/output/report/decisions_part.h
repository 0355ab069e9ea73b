#pragma once

#include "patchlight/plan/effects.h"

#include <nlohmann/json.hpp>
#include <vector>

namespace patchlight {

/// An array of objects with effect, simulate, reason, saving and forced.
nlohmann::ordered_json decisions_part(const std::vector<Decision>& decisions);

}  // namespace patchlight
