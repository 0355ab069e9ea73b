#pragma once

#include "patchlight/light/material.h"
#include "patchlight/scene/scene.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// Linear value of an sRGB value, both 0 to 1.
double linear_of_srgb(double value);

/// Pixels of a picture by alpha, 0 to 255.
struct AlphaColours {
  std::array<std::size_t, 256> count{};          ///< number of pixels with this alpha
  std::array<std::array<double, 3>, 256> sum{};  ///< the sum of their linear RGB
};

/// The covered part of a surface with holes in its picture.
struct Coverage {
  double share = 1;  ///< covered fraction of the surface
  Spectrum colour;   ///< mean linear RGB of the covered part; black if nothing is covered
};

/// The coverage by a picture; a pixel with an alpha in [0, 1] covers the fraction `covered(alpha)` of its area.
Coverage coverage_by(const AlphaColours& picture, const std::function<double(double)>& covered);

/// A decoded picture.
struct DecodedPicture {
  std::optional<Spectrum> mean;                 ///< linear RGB; empty where decoding failed
  std::shared_ptr<const Texture> texture;       ///< null for pictures of one color
  std::shared_ptr<const AlphaColours> alpha{};  ///< null for opaque pictures
  double number = 0;                            ///< mean of red, green and blue as stored, 0 to 1, not gamma encoded
  std::string fault{};                          ///< reason for a failure, e.g. "is cut off"
};

/// Decodes a picture in a format of decoded_pixels(). Pictures with more than `most_texels` pixels are reduced by
/// averaging.
DecodedPicture decoded_picture(std::string_view picture, std::size_t most_texels);

/// The most texels kept of all pictures of a model, and of one picture.
inline constexpr std::size_t most_texels_of_model = std::size_t{1} << 24U;
inline constexpr std::size_t most_texels_of_picture = std::size_t{1} << 20U;

/// The texture with at most this many texels.
Texture reduced(const Texture& texture, std::size_t most_texels);

/// The note on partly covered materials, before their names and fractions.
inline constexpr const char* covered_note =
    "surfaces cut out by pictures are partly transparent, each face by the fraction that its whole picture covers; "
    "error bars do not include the effect of hole positions";

/// A picture as a mask of a surface.
struct PictureMask {
  double covered = 1;              ///< mean of alpha, or of the numbers of an opaque picture
  std::optional<Spectrum> colour;  ///< mean linear RGB of the covered part, for pictures with alpha
};

/// Mean colors of picture files.
struct PictureColours {
  std::map<std::string, Spectrum> by_file;                         ///< readable pictures
  std::map<std::string, std::shared_ptr<const Texture>> textures;  ///< pictures with more than one color
  std::map<std::string, PictureMask> masks;                        ///< readable pictures
  std::map<std::string, std::string> faults;                       ///< unreadable pictures, e.g. "is not there"
  std::vector<std::string> digests;                                ///< for the checksum of the model
};

/// Decodes all pictures in one child process. Files that are missing, unreadable or outside the folder `confine` (if
/// given) get a fault. `model` is the file that names the pictures.
PictureColours picture_colours(const std::vector<std::filesystem::path>& files, const std::filesystem::path& confine,
                               const std::string& model);

/// Frees memory from malloc().
struct FreeMemory {
  void operator()(void* memory) const { std::free(memory); }
};

/// Pixels of a picture, row by row from the top, either as codes or as linear numbers.
struct PicturePixels {
  std::size_t width = 0;
  std::size_t height = 0;
  std::size_t channels = 0;                            ///< gray, gray and alpha, RGB, or RGB and alpha
  std::unique_ptr<unsigned char[], FreeMemory> codes;  ///< of sRGB; alpha is linear
  std::unique_ptr<float[], FreeMemory> linear;         ///< Radiance pictures, Rec. 709 primaries
  bool has_alpha = false;                              ///< the last channel is a meaningful alpha
  std::string fault;  ///< reason for a failure, e.g. "is cut off"; all else is empty then
};

/// Decodes PNG, JPEG, BMP and TGA up to 8192 x 8192 pixels and Radiance HDR up to 4096 x 8192. Keeps the upper eight of
/// 16 bits. Peak memory: two buffers of 3 to 4 bytes a pixel, three times as much for 16 bits and HDR.
PicturePixels decoded_pixels(std::string_view picture);

/// The reflectances of pictures of pure red, green and blue of value 1, times a color of three bands.
std::array<Spectrum, 3> primaries_times(const Spectrum& factor);

/// Maps of faces into pictures, in sequence, and their faults.
class MappedFaces {
 public:
  explicit MappedFaces(std::string file) : file_(std::move(file)) {}

  /// Adds a map for a face with these corners (m) and their points in the picture, and returns its index. For more than
  /// three corners the map is the affine least-squares fit. Returns no_texture_map for a face without area, or without
  /// finite points. `line` 0: unknown.
  std::uint32_t add(std::span<const Point> corners, std::span<const Eigen::Vector2d> places, std::uint32_t line);

  /// The same for corners that index the vertices of a scene. `places` begin at the vertex `first`. Line 0.
  std::uint32_t add(std::span<const Point> vertices, std::span<const std::uint32_t> corners, std::uint32_t first,
                    std::span<const Eigen::Vector2d> places);

  const std::vector<TextureMap>& maps() const { return maps_; }

  /// The numbers of faces without a valid map and with a non-affine map, each with the first face.
  Diagnostics notes() const;

 private:
  struct Faces {
    std::size_t count = 0;
    std::uint32_t first_line = 0;
  };
  static void count(Faces& faces, std::uint32_t line);
  std::string sentence(const Faces& faces, const std::string& what) const;

  std::string file_;
  std::vector<TextureMap> maps_;
  Faces without_;
  Faces bent_;
};

}  // namespace patchlight
