#pragma once

#include "patchlight/output/provenance.h"

#include "study/compare.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// What write_comparison() writes as compare.json. Names from a model may hold bytes that are not UTF-8.
nlohmann::ordered_json comparison_json(const Scene& scene, const Comparison& comparison, const Provenance& provenance);

}  // namespace patchlight
