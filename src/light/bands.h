#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

namespace patchlight {

/// What the bands of spectra and the columns of fields stand for: three are linear RGB with Rec. 709 primaries, any
/// other number are equal parts of the visible light.
struct Bands {
  Eigen::Index number = 3;

  /// The share of a band's radiance in luminance; those of all bands sum up to 1.
  double luminous_weight(Eigen::Index band) const;

  /// The linear RGB (Rec. 709) that a radiance of 1 in a band is shown as; those of all bands sum up to white.
  std::array<double, 3> rgb(Eigen::Index band) const;

  /// "r", "g" and "b", or "1", "2", and so on.
  std::string name(Eigen::Index band) const;
};

}  // namespace patchlight
