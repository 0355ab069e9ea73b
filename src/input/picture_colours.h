#pragma once

#include "patchlight/light/spectrum.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// The mean colour, linear RGB, of a picture in PNG or JPEG; nothing for another one, one that cannot be decoded, or
/// one with more than 8192 x 8192 pixels.
std::optional<Spectrum> mean_colour(std::string_view picture);

/// The mean colours of picture files.
struct PictureColours {
  std::map<std::string, Spectrum> by_file;  ///< of those that could be read
  std::vector<std::string> digests;         ///< of the same, for the checksum of what they belong to
};

/// Pictures are decoded in a process of their own, all in one. Those that are not there, cannot be read or do not lie
/// in the folder `confine`, if there is one, are passed over. `model` is the file that names them.
PictureColours picture_colours(const std::vector<std::filesystem::path>& files, const std::filesystem::path& confine,
                               const std::string& model);

}  // namespace patchlight
