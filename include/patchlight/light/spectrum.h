#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace patchlight {

/// One value per spectral band. Files with colors have three bands: linear RGB with Rec. 709 primaries.
using Spectrum = Eigen::Array<double, 1, Eigen::Dynamic>;

/// A three-band spectrum.
inline Spectrum rgb(double red, double green, double blue) {
  Spectrum spectrum(3);
  spectrum << red, green, blue;
  return spectrum;
}

/// The meaning of one band.
struct Band {
  std::string name;             ///< in tables: "r", "550 nm"
  double luminous_weight = 0;   ///< the luminance of a radiance of 1 W/(m^2 sr), in 179 cd/m^2; for colors a share,
                                ///< those of all bands sum up to 1
  std::array<double, 3> rgb{};  ///< the linear RGB (Rec. 709) that a radiance of 1 is shown as, where white of 179
                                ///< cd/m^2 is 1, 1, 1
  std::array<double, 2> edges_nm{};  ///< its wavelengths; both 0 where it has none, e.g. a color
};

/// The meaning of the bands of a scene's spectra, and of the columns of its fields, in their order.
using Bands = std::vector<Band>;

/// Values by wavelength, linear between those given.
struct SampledSpectrum {
  std::string name;                 ///< of its file, or "D65"
  std::vector<double> wavelengths;  ///< nm, growing; one or more
  std::vector<double> values;       ///< one for each
};

/// The default meaning of so many bands: three are linear RGB with Rec. 709 primaries, "r", "g"
/// and "b"; any other number are equal parts of the visible light, "1", "2", and so on.
Bands usual_bands(Eigen::Index number);

}  // namespace patchlight
