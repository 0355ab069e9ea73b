#pragma once

#include "patchlight/output/write_result.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "pipeline/expected_cost.h"
#include "plan/survey.h"
#include "study/verify.h"
#include "validate/validate.h"

#include <filesystem>
#include <span>
#include <string>

namespace patchlight {

/// The plan of a run and its expected cost, as JSON. docs/reference/outputs/report-json.md lists the keys.
std::string plan_json(const Scene& scene, const Plan& plan, const ExpectedCost& cost);

/// The contents of a scene and its problems as JSON. Each problem lists at most 1,000 faces.
std::string survey_json(const Scene& scene, const SceneReport& report);

/// The outcome of a validation as JSON. docs/reference/outputs/report-json.md lists the keys.
std::string validation_json(std::span<const ValidationResult> results);

/// The outcome of a verification as a JSON file; docs/reference/outputs/report-json.md lists the keys. \throws
/// OutputError.
void write_verification(const std::filesystem::path& file, const Scene& scene, const Simulation& simulation,
                        const Verification& verification, const Provenance& provenance);

}  // namespace patchlight
