#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Linear values per pixel (row) and band (column); pixels from the upper left corner, row by row.
struct Image {
  int width = 0;
  int height = 0;
  Field pixels;
  Eigen::VectorXd outlook = {};          ///< per pixel: the share of the view behind clear faces or past all things
  Eigen::VectorXd error = {};            ///< per pixel: standard error of its luminance, cd/m^2; empty: not known
  std::vector<std::int64_t> patch = {};  ///< that the middle of each pixel shows; -1: none
  Eigen::VectorXd depth = {};            ///< meters from the eye to there; infinite where nothing is
  Field normal = {};                     ///< unit, of that patch, three columns; 0 where nothing is
};

/// Eight bits per channel, sRGB-encoded, from the upper left corner, row by row.
struct DisplayImage {
  int width = 0;
  int height = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;
};

/// Faces in one plane, and their place in a map of texels. The texel in column x and row y of the chart begins at
/// corner + texel (x right + y down).
struct LightmapChart {
  std::vector<PatchIndex> patches;
  Point corner = Point::Zero();    ///< meters, of its upper left texel
  Vector right = Vector::Zero();   ///< unit, along rows
  Vector down = Vector::Zero();    ///< unit, along columns
  std::array<double, 2> extent{};  ///< along both, meters
  std::array<double, 2> texel{};   ///< edges, meters: the extent is a whole number of them
  int left = 0, top = 0;           ///< of that texel in the map
  int width = 0, height = 0;       ///< texels
};

/// A value per texel (row) and band (column).
using TexelField = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The light on surfaces at texels, means over the part of each that is a surface. Texels from the upper left corner,
/// row by row. Around charts, and without a surface or with one in a solid, texels continue the light beside them.
struct Lightmap {
  int width = 0;
  int height = 0;
  double texel = 0;  ///< longest edge, meters; those of charts may be shorter
  std::vector<LightmapChart> charts;
  std::vector<PatchIndex> patch;  ///< one that lies on the texel; no_patch where none is to be seen
  TexelField direct;              ///< irradiance straight from lamps that are bright, luminaires, sun and sky, W/m^2
  TexelField indirect;            ///< irradiance by all other light
  TexelField radiance;            ///< that leaves the surface, W/(m^2 sr)
  Eigen::ArrayXf error;           ///< standard error of the indirect illuminance by the rays that gather it, lx
};

}  // namespace patchlight
