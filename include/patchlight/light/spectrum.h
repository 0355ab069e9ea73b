#pragma once

#include <Eigen/Core>

namespace patchlight {

/// One value per spectral band. Files with colours have three bands: linear RGB with Rec. 709 primaries.
using Spectrum = Eigen::Array<double, 1, Eigen::Dynamic>;

/// A three-band spectrum.
inline Spectrum rgb(double red, double green, double blue) {
  Spectrum spectrum(3);
  spectrum << red, green, blue;
  return spectrum;
}

}  // namespace patchlight
