#include "patchlight/light/photometry.h"

namespace patchlight {

double luminance(const Spectrum& radiance) {
  if (radiance.size() != 3) return luminous_efficacy * radiance.mean();
  return luminous_efficacy * (0.2126 * radiance[0] + 0.7152 * radiance[1] + 0.0722 * radiance[2]);  // Rec. 709
}

}  // namespace patchlight
