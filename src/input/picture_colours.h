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

/// A value of sRGB, 0 to 1, as a linear one.
double linear_of_srgb(double value);

/// The pixels of a picture by their alpha, of 0 to 255.
struct AlphaColours {
  std::array<std::size_t, 256> count{};          ///< those with this alpha
  std::array<std::array<double, 3>, 256> sum{};  ///< the sum of their linear RGB
};

/// The cover of a surface that a picture leaves free in places.
struct Coverage {
  double share = 1;  ///< of the surface
  Spectrum colour;   ///< the mean of what covers it, linear RGB; black where nothing does
};

/// The coverage where a pixel of an alpha in [0, 1] covers the share `covered(alpha)` of its place.
Coverage coverage_by(const AlphaColours& picture, const std::function<double(double)>& covered);

/// A picture as it was decoded.
struct DecodedPicture {
  std::optional<Spectrum> mean;                 ///< linear RGB; nothing where it could not be decoded
  std::shared_ptr<const Texture> texture;       ///< null where all of it has one color
  std::shared_ptr<const AlphaColours> alpha{};  ///< null where all of it is opaque
  double number = 0;    ///< the mean of red, green and blue as a picture of numbers has them, 0 to 1, not gamma encoded
  std::string fault{};  ///< why it could not be decoded: "is cut off"
};

/// A picture in a format of decoded_pixels(). Larger ones than `most_texels` are reduced to as many, each the mean of
/// what it takes the place of.
DecodedPicture decoded_picture(std::string_view picture, std::size_t most_texels);

/// So many texels are kept of all pictures of a model together, and of one of them.
inline constexpr std::size_t most_texels_of_model = std::size_t{1} << 24U;
inline constexpr std::size_t most_texels_of_picture = std::size_t{1} << 20U;

/// The texture with at most so many texels.
Texture reduced(const Texture& texture, std::size_t most_texels);

/// The note on materials that are there in part, before their names and shares.
inline constexpr const char* covered_note =
    "surfaces cut out by pictures are there in part, every face by the share that its whole picture covers; no "
    "error bar holds where its holes are";

/// A picture as the mask of a surface.
struct PictureMask {
  double covered = 1;              ///< the mean of its alpha, or of its numbers where all of it is opaque
  std::optional<Spectrum> colour;  ///< where it has alpha: the mean linear RGB of what it covers
};

/// The mean colors of picture files.
struct PictureColours {
  std::map<std::string, Spectrum> by_file;                         ///< of those that could be read
  std::map<std::string, std::shared_ptr<const Texture>> textures;  ///< of those with more than one color
  std::map<std::string, PictureMask> masks;                        ///< of those that could be read
  std::map<std::string, std::string> faults;                       ///< of the others: "is not there"
  std::vector<std::string> digests;                                ///< for the checksum of what they belong to
};

/// Pictures are decoded in a process of their own, all in one. Those that are not there, cannot be read or do not lie
/// in the folder `confine`, if there is one, have a fault. `model` is the file that names them.
PictureColours picture_colours(const std::vector<std::filesystem::path>& files, const std::filesystem::path& confine,
                               const std::string& model);

/// Memory that malloc() gave.
struct FreeMemory {
  void operator()(void* memory) const { std::free(memory); }
};

/// The pixels of a picture, row by row from the top, either as codes or as linear numbers.
struct PicturePixels {
  std::size_t width = 0;
  std::size_t height = 0;
  std::size_t channels = 0;                            ///< gray, gray and alpha, RGB, or RGB and alpha
  std::unique_ptr<unsigned char[], FreeMemory> codes;  ///< of sRGB; alpha is linear
  std::unique_ptr<float[], FreeMemory> linear;         ///< of Radiance's pictures, with Rec. 709 primaries
  bool has_alpha = false;                              ///< the last channel is one, and it means something
  std::string fault;  ///< why it could not be decoded, "is cut off"; then there is nothing else
};

/// Decodes PNG, JPEG, BMP and TGA of at most 8192 x 8192 pixels and Radiance HDR of at most 4096 x 8192. Of 16 bits the
/// upper eight are taken. Takes three to four bytes a pixel twice, of 16 bits and of HDR three times as much.
PicturePixels decoded_pixels(std::string_view picture);

/// The reflectances of a picture of 1 in red, in green and in blue alone, times a color of three bands.
std::array<Spectrum, 3> primaries_times(const Spectrum& factor);

/// The maps of faces into pictures, one after the other, and their faults.
class MappedFaces {
 public:
  explicit MappedFaces(std::string file) : file_(std::move(file)) {}

  /// The index of a new map for a face with these corners, m, which lie there in its picture; that of the affine map
  /// that comes nearest, where it has more than three corners. no_texture_map for a face without area, and for one
  /// whose places are not known: there are none, or they are not finite. `line` 0: not known.
  std::uint32_t add(std::span<const Point> corners, std::span<const Eigen::Vector2d> places, std::uint32_t line);

  /// The same for corners among the vertices of a scene, those from `first` on having these places. Line 0.
  std::uint32_t add(std::span<const Point> vertices, std::span<const std::uint32_t> corners, std::uint32_t first,
                    std::span<const Eigen::Vector2d> places);

  const std::vector<TextureMap>& maps() const { return maps_; }

  /// How many faces have no place in their picture, or a bent one, and which is the first.
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
