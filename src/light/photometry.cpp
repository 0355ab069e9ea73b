#include "light/photometry.h"

#include "light/bands.h"

namespace patchlight {

double luminance(const Spectrum& radiance) {
  const Bands bands{radiance.size()};
  double visible = 0;
  for (Eigen::Index band = 0; band < bands.number; ++band) visible += bands.luminous_weight(band) * radiance[band];
  return luminous_efficacy * visible;
}

}  // namespace patchlight
