#pragma once

#include "patchlight/render/image.h"

#include <filesystem>

namespace patchlight {

/// Writes a PNG. \throws OutputError.
void write_png(const std::filesystem::path& file, const DisplayImage& image);

/// The image with a legend of false colours at its right: a colour bar with numbers from `lower` to `upper` and
/// `title`.
DisplayImage with_legend(const DisplayImage& image, double lower, double upper, const std::string& title);

}  // namespace patchlight
