#pragma once

#include "patchlight/output/write_report.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// What sensors read, group by group, as a part of the report.
nlohmann::ordered_json sensors_part(const SensorReport& sensors);

}  // namespace patchlight
