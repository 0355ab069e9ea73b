#pragma once

#include "patchlight/light/spectrum.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// What bands stand for, one entry per band.
nlohmann::ordered_json json_of(const Bands& bands);

/// The same back. \throws what nlohmann::json throws where a part is missing or of another shape.
Bands bands_from(const nlohmann::ordered_json& json);

}  // namespace patchlight
