#pragma once

#include "plan/survey.h"

#include <filesystem>
#include <string>

namespace patchlight {

/// What a scene holds and what is wrong with it as JSON. Of the faces of each problem the first 1,000 are listed.
std::string survey_json(const Scene& scene, const SceneReport& report);

/// The same as a file. \throws OutputError.
void write_survey(const std::filesystem::path& file, const Scene& scene, const SceneReport& report);

}  // namespace patchlight
