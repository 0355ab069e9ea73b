#pragma once

#include "patchlight/output/write_image.h"

#include <string>
#include <vector>

namespace patchlight {

/// The image as the bytes of a PNG; empty when it cannot be encoded.
std::string png_bytes(const DisplayImage& image, const std::vector<PngText>& texts = {});

}  // namespace patchlight
