#pragma once

#include "patchlight/light/material.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// A picture as it was decoded.
struct DecodedPicture {
  std::optional<Spectrum> mean;            ///< linear RGB; nothing where it could not be decoded
  std::shared_ptr<const Texture> texture;  ///< null where all of it has one colour
  std::string fault;                       ///< why it could not be decoded: "is cut off"
};

/// A picture in PNG or JPEG of at most 8192 x 8192 pixels. Larger ones than `most_texels` are reduced to as many, each
/// the mean of what it takes the place of.
DecodedPicture decoded_picture(std::string_view picture, std::size_t most_texels);

/// So many texels are kept of all pictures of a model together, and of one of them.
inline constexpr std::size_t most_texels_of_model = std::size_t{1} << 24U;
inline constexpr std::size_t most_texels_of_picture = std::size_t{1} << 20U;

/// The texture with at most so many texels.
Texture reduced(const Texture& texture, std::size_t most_texels);

/// The mean colours of picture files.
struct PictureColours {
  std::map<std::string, Spectrum> by_file;                         ///< of those that could be read
  std::map<std::string, std::shared_ptr<const Texture>> textures;  ///< of those with more than one colour
  std::map<std::string, std::string> faults;                       ///< of the others: "is not there"
  std::vector<std::string> digests;                                ///< for the checksum of what they belong to
};

/// Pictures are decoded in a process of their own, all in one. Those that are not there, cannot be read or do not lie
/// in the folder `confine`, if there is one, have a fault. `model` is the file that names them.
PictureColours picture_colours(const std::vector<std::filesystem::path>& files, const std::filesystem::path& confine,
                               const std::string& model);

}  // namespace patchlight
