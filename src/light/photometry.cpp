#include "light/photometry.h"

#include <cassert>
#include <cmath>

namespace patchlight {

double luminance(const Spectrum& radiance, const Bands& bands) {
  assert(static_cast<std::size_t>(radiance.size()) == bands.size());
  double visible = 0;
  for (std::size_t band = 0; band < bands.size(); ++band)
    visible += bands[band].luminous_weight * radiance[static_cast<Eigen::Index>(band)];
  return luminous_efficacy * visible;
}

Spectrum luminous_shares(const Bands& bands) {
  Spectrum weights(static_cast<Eigen::Index>(bands.size()));
  double sum = 0;
  for (std::size_t band = 0; band < bands.size(); ++band)
    sum += weights[static_cast<Eigen::Index>(band)] = bands[band].luminous_weight;
  // Those of colours sum up to 1 as they are, up to rounding.
  constexpr double rounding = 1e-9;
  return std::abs(sum - 1) <= rounding || !(sum > 0) ? weights : Spectrum(weights / sum);
}

double luminance(const Spectrum& radiance) { return luminance(radiance, usual_bands(radiance.size())); }

}  // namespace patchlight
