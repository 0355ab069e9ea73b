#pragma once

#include "plan/survey.h"

#include <filesystem>

namespace patchlight {

/// Writes a scene and the faces that are wrong in it as VTK XML PolyData (.vtp) for ParaView. Cell arrays: problem_kind
/// (0: a polygon with nothing wrong; else the place of its problem in the field array problem_names, from 1), severity
/// (0 nothing, 1 remark, 2 warning, 3 error), source_file, source_line and source_polygon. A face with several problems
/// is there once for each; faces that were left out are there as the model has them. \throws OutputError.
void write_problems(const std::filesystem::path& file, const Scene& scene, const SceneReport& report);

}  // namespace patchlight
