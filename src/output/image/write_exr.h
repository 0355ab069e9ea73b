#pragma once

#include "patchlight/views/picture.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// Numbers of pixels in single precision, from the upper left corner, row by row.
struct ExrChannel {
  std::string name;
  std::vector<float> values;
};

/// Writes channels of equal size as OpenEXR, with a comment if there is one. \throws OutputError.
void write_exr(const std::filesystem::path& file, int width, int height, const std::vector<ExrChannel>& channels,
               const std::string& comment = "");

/// Writes a picture as OpenEXR: R, G, B in W/(m^2 sr), luminance.Y and error.Y in cd/m^2, depth.Z in metres, normal.X,
/// Y and Z, and patch.id, the number of a patch from 0, or -1 as 4294967295 where none is. Without what the picture has
/// not. \throws OutputError.
void write_exr(const std::filesystem::path& file, const Picture& picture, const Bands& bands);

}  // namespace patchlight
