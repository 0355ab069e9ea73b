#pragma once

#include "patchlight/output/write_result.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include <cstddef>
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

/// Writes a picture as OpenEXR, with the channels that the picture has:
/// - R, G, B in W/(m^2 sr);
/// - luminance.Y and error.Y in cd/m^2,
/// - depth.Z in meters;
/// - normal.X, normal.Y and normal.Z,
/// - patch.id, the number of a patch from 0; 4294967295 where there is none.
/// \throws OutputError.
void write_exr(const std::filesystem::path& file, const Picture& picture, const Bands& bands);

/// The extensions that write_picture() knows: ".png", ".hdr", ".exr".
const std::vector<std::string>& picture_extensions();

/// Writes a picture in the format that the extension names: as it is shown, with a legend where its colors are false
/// and the exposure as text (.png); its radiances in W/(m^2 sr), with the view as Radiance writes it (.hdr); these,
/// luminance, errors, and layers for depth, normal and patch (.exr). docs/reference/outputs/images.md. \throws
/// OutputError.
void write_picture(const std::filesystem::path& file, const Picture& picture, const Vector& up, const Bands& bands);

/// Writes two pictures of one size beside each other, exposed as the first, and in false colors by how much their
/// luminances differ (.png). \throws OutputError.
void write_difference(const std::filesystem::path& file, const Picture& first, const Picture& second,
                      const Bands& bands);

/// Writes the standard errors of the pixels of a final picture in false colors (.png). \throws OutputError.
void write_picture_errors(const std::filesystem::path& file, const Picture& picture);

/// Writes the readings of observers (.csv), a line for each: name, vertical and cylindrical illuminance in lx,
/// background luminance in cd/m^2, solid angle of the sources of glare in sr, and UGR, empty without any. \throws
/// OutputError.
void write_observers(const std::filesystem::path& file, std::span<const ObserverReading> observers);

/// Writes a lightmap as a folder: irradiance, direct and indirect as .exr, linear in W/m^2, and as .png, as a white
/// matt surface would look; lightmap.glb and baked.glb; and lightmap.json with its facts. The folder appears as a
/// whole. \throws OutputError, also when it holds anything else than an earlier lightmap.
void write_lightmap(const std::filesystem::path& folder, const Scene& scene, const Simulation& simulation,
                    const Lightmap& map, const Provenance& provenance);

/// Fails early: \throws OutputError when write_lightmap could not write here.
void check_lightmap_writable(const std::filesystem::path& folder);

/// Bytes that the map takes in memory.
std::size_t bytes_of(const Lightmap& map);

}  // namespace patchlight
