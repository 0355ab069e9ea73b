#pragma once

#include "patchlight/output/provenance.h"

#include "study/study.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// What write_study() writes as study.json. Names from a model may hold bytes that are not UTF-8.
nlohmann::ordered_json study_json(const Scene& scene, const Study& study, const Provenance& provenance);

}  // namespace patchlight
