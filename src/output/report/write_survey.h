#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "pipeline/expected_cost.h"
#include "plan/survey.h"

#include <filesystem>
#include <string>

namespace patchlight {

/// The plan of a run and its expected cost, as JSON. docs/reference/outputs/report-json.md lists the keys.
std::string plan_json(const Scene& scene, const Plan& plan, const ExpectedCost& cost);

/// The same as a file. \throws OutputError.
void write_plan(const std::filesystem::path& file, const Scene& scene, const Plan& plan, const ExpectedCost& cost);

/// What a scene holds and what is wrong with it as JSON. Of the faces of each problem the first 1,000 are listed.
std::string survey_json(const Scene& scene, const SceneReport& report);

/// The same as a file. \throws OutputError.
void write_survey(const std::filesystem::path& file, const Scene& scene, const SceneReport& report);

}  // namespace patchlight
