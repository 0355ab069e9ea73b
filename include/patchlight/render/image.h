#pragma once

#include "patchlight/base/field.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Linear values per pixel (row) and band (column); pixels from the upper left corner, row by row.
struct Image {
  int width = 0;
  int height = 0;
  Field pixels;
  Eigen::VectorXd outlook = {};  ///< per pixel: the share of what is seen behind clear faces, or where nothing is
};

/// Eight bits per channel, sRGB-encoded, from the upper left corner, row by row.
struct DisplayImage {
  int width = 0;
  int height = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;
};

}  // namespace patchlight
