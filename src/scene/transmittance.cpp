#include "scene/transmittance.h"

#include "light/photometry.h"

#include <algorithm>

namespace patchlight {

double mean_transmittance(const Scene& scene, PolygonIndex polygon) {
  double sum = 0;
  for (const Side side : {Side::front, Side::back}) {
    const Spectrum& share = scene.materials[material_on(scene.polygons[polygon], side)].transmittance;
    if (share.size() > 0) sum += luminance(share, bands_of(scene)) / luminous_efficacy;
  }
  return sum / 2;
}

double held_of(double mean_transmittance) {
  constexpr double least = 1e-6;
  return std::max(least, 1 - mean_transmittance);
}

}  // namespace patchlight
