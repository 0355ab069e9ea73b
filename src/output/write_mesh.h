#pragma once

#include "patchlight/form_factors.h"
#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Writes the patches that form factors belong to, in their order, as VTK XML PolyData (.vtp). Cell arrays: area (the
/// exposed part, m^2), row_sum, raw_row_sum, material_id, object_id, source_polygon. FieldData: material_names,
/// object_names. \throws OutputError.
void write_mesh(const std::filesystem::path& file, const Scene& scene, const FormFactors& form_factors);

}  // namespace patchlight
