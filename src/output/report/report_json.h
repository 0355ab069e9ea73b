#pragma once

#include "patchlight/output/provenance.h"
#include "patchlight/report/report.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// The report as write_report() writes it. Names from a model may hold bytes that are not UTF-8.
nlohmann::ordered_json report_json(const Report& report, const Provenance& provenance);

}  // namespace patchlight
