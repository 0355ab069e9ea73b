#pragma once

#include "input/picture_colours.h"
#include "input/read_mtl.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The pictures that map_Kd and map_d name. `model` is the file that names the material files.
PictureColours pictures_of(std::span<const MtlMaterial> materials, const std::filesystem::path& confine,
                           const std::string& model);

/// The materials with the pictures of map_Kd and their mean colours, times Kd where it is not 0, as exporters write it
/// beside a picture, and with the holes of those of map_d. Where map_d is the picture of map_Kd its alpha counts, and
/// without any it makes no holes.
std::vector<MtlMaterial> with_pictures(std::vector<MtlMaterial> materials, const PictureColours& pictures);

/// One sentence for each map_Kd and map_d whose picture cannot be read, and one on those that leave holes.
std::vector<std::string> notes_on_pictures(std::span<const MtlMaterial> materials, const PictureColours& pictures);

}  // namespace patchlight
