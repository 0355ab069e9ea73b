#include "light/photometry.h"

#include <cassert>

namespace patchlight {

double luminance(const Spectrum& radiance, const Bands& bands) {
  assert(static_cast<std::size_t>(radiance.size()) == bands.size());
  double visible = 0;
  for (std::size_t band = 0; band < bands.size(); ++band)
    visible += bands[band].luminous_weight * radiance[static_cast<Eigen::Index>(band)];
  return luminous_efficacy * visible;
}

double luminance(const Spectrum& radiance) { return luminance(radiance, usual_bands(radiance.size())); }

}  // namespace patchlight
