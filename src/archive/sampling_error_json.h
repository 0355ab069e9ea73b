#pragma once

#include "patchlight/transport/sampling_error.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// The counts of the audit, and the bounds that follow; null when no pair was sampled a second time.
nlohmann::ordered_json json_of(const SamplingError& error);

/// The same back; of null an empty one. \throws what nlohmann::json throws where a part is missing or of another shape.
SamplingError sampling_error_of(const nlohmann::json& json);

}  // namespace patchlight
