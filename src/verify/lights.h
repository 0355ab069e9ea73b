#pragma once

#include "lighting/lighting.h"

#include <array>
#include <span>
#include <vector>

namespace patchlight {

/// A place where light arrives, with what chooses its shadow rays: three independent numbers of [0, 1).
struct LitPlace {
  SurfacePoint at;
  double choice = 0;        ///< of the luminaire
  Eigen::Vector2d uv = {};  ///< of the point on it
};

/// Irradiance straight from luminaires and sun, W/m^2: a row per place, a column per band. One shadow ray goes to the
/// sun and one to a luminaire, each of which is chosen with the probability of what it would give if nothing stood in
/// the way; the mean over `choice` and `uv` is what all of them give. Clear openings let their share through.
Field irradiance_by_lights(const Lighting& lighting, std::span<const LitPlace> places);

/// The same by way of mirrors and clear faces, over each chain of Lighting::mirrors; 0 without any.
Field irradiance_in_mirrors(const Lighting& lighting, std::span<const LitPlace> places);

/// The radiance of sky and ground that gets to the origins of rays, W/(m^2 sr): a row per ray, a column per band.
/// Nothing from behind something opaque.
Field radiance_from_outside(const Lighting& lighting, std::span<const Ray> rays);

}  // namespace patchlight
