#pragma once

#include "patchlight/light/material.h"

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace patchlight {

/// Linear red, green and blue.
using Rgb = std::array<double, 3>;

/// The reflectance where a picture has this color.
Spectrum reflectance_of(const TexturedReflectance& textured, const Rgb& colour);

/// The reflectance at a place of the picture, (u, v): that of the texel there.
Spectrum reflectance_at(const TexturedReflectance& textured, const Eigen::Vector2d& place);

/// The mean of all texels.
Rgb mean_colour(const Texture& texture);

/// True where a texel reflects more than 1 in a band, by more than rounding.
bool reflects_more_than_all(const TexturedReflectance& textured);

/// The extremes and the spread over all texels of a picture.
struct TextureRange {
  double highest_reflectance = 0;  ///< worst band
  bool grey = true;                ///< the reflectance is the same in all bands, everywhere
  double deviation = 0;  ///< root of the mean square of (rho - mean) / mean, worst band; 0 where the mean is 0
};

TextureRange range_of(const TexturedReflectance& textured);

/// Means of a picture over polygons. Texels have one color each: means are exact.
class TextureMeans {
 public:
  /// O(texels) of time; three times the memory of the picture.
  explicit TextureMeans(const TexturedReflectance& textured);

  /// The mean color over a simple polygon in the picture's coordinates, its corners in either sense. That at its
  /// middle where it has no area, and that of the whole picture where it is more than a million texels around. O(texels
  /// that its outline crosses).
  Rgb over(std::span<const Eigen::Vector2d> corners) const;

 private:
  Rgb sum_to(double x, std::size_t row) const;
  Rgb outline_integral(const Eigen::Vector2d& begin, const Eigen::Vector2d& to, double base) const;

  TexturedReflectance textured_;
  std::vector<Rgb> sums_;  // at row * (width + 1) + column: of all texels of the row left of that column
  Rgb mean_;
};

}  // namespace patchlight
