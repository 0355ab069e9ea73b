#pragma once

#include "patchlight/base/field.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// Writes a CSV: a header line, then the given columns of each line followed by the irradiance per band in W/m^2 (E_r,
/// E_g, E_b for three bands). \throws OutputError.
void write_points(const std::filesystem::path& file, const std::vector<std::string>& lines,
                  const FieldView& irradiance);

}  // namespace patchlight
