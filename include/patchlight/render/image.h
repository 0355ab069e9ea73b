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
  Eigen::VectorXd error = {};    ///< per pixel: standard error of its luminance, cd/m^2; empty: not known
  std::vector<std::int64_t> patch = {};  ///< that the middle of each pixel shows; -1: none
  Eigen::VectorXd depth = {};            ///< metres from the eye to there; infinite where nothing is
  Field normal = {};                     ///< unit, of that patch, three columns; 0 where nothing is
};

/// Eight bits per channel, sRGB-encoded, from the upper left corner, row by row.
struct DisplayImage {
  int width = 0;
  int height = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;
};

}  // namespace patchlight
