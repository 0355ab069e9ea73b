#pragma once

#include "patchlight/views/picture.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// The extensions that write_picture() knows: ".png", ".hdr", ".exr".
const std::vector<std::string>& picture_extensions();

/// Writes a picture in the format that the extension names: as it is shown, with a legend where its colours are false
/// and the exposure as text (.png); its radiances in W/(m^2 sr), with the view as Radiance writes it (.hdr); these,
/// luminance, errors, and what each pixel shows in layers (.exr). docs/reference/outputs/images.md. \throws
/// OutputError.
void write_picture(const std::filesystem::path& file, const Picture& picture, const Vector& up, const Bands& bands);

/// Writes two pictures of one size beside each other, exposed as the first, and in false colours by how much their
/// luminances differ (.png). \throws OutputError.
void write_difference(const std::filesystem::path& file, const Picture& first, const Picture& second,
                      const Bands& bands);

/// Writes the standard errors of the pixels of a final picture in false colours (.png). \throws OutputError.
void write_picture_errors(const std::filesystem::path& file, const Picture& picture);

}  // namespace patchlight
