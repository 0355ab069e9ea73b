#pragma once

#include "patchlight/report/report.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// What floor, walls and ceiling of each room get, as a part of the report.
nlohmann::ordered_json rooms_part(const Report& report);

}  // namespace patchlight
