#pragma once

#include "patchlight/output/write_image.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The image as the bytes of a PNG; empty when it cannot be encoded.
std::string png_bytes(const DisplayImage& image, const std::vector<PngText>& texts = {});

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

/// Writes the readings of observers (.csv), a line for each: name, vertical and cylindrical illuminance in lx,
/// background luminance in cd/m^2, solid angle of what glares in sr, and UGR, empty where nothing does. \throws
/// OutputError.
void write_observers(const std::filesystem::path& file, std::span<const ObserverReading> observers);

}  // namespace patchlight
