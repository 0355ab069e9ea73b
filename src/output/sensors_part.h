#pragma once

#include "patchlight/report/report.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// What sensors read, group by group, as a part of the report.
nlohmann::ordered_json sensors_part(const SensorFacts& sensors);

}  // namespace patchlight
