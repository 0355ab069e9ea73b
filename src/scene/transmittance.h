#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The share of light that goes straight through a polygon, one number for all bands and both ways: the mean of its two
/// sides, each weighted as luminance is. 0: opaque.
double mean_transmittance(const Scene& scene, PolygonIndex polygon);

/// The share of light that is kept, to be reflected or absorbed: 1 less the transmittance, and 1e-6 at least.
double held_of(double mean_transmittance);

}  // namespace patchlight
