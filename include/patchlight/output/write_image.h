#pragma once

#include "patchlight/render/image.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// A text that goes with a PNG.
struct PngText {
  std::string keyword;
  std::string text;
};

/// Writes a PNG. \throws OutputError.
void write_png(const std::filesystem::path& file, const DisplayImage& image, const std::vector<PngText>& texts = {});

/// The image with a legend of false colours at its right: a colour bar with numbers from `lower` to `upper` and
/// `title`.
DisplayImage with_legend(const DisplayImage& image, double lower, double upper, const std::string& title);

}  // namespace patchlight
