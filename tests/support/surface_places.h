#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/sensor.h"
#include "patchlight/simulate.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight::test {

/// A place on an opaque matte surface, and the distance along its normal that is free for a camera.
struct SurfacePlace {
  Sensor sensor;
  PatchIndex patch = 0;
  double free_distance = 0;  ///< meters
  double width = 0;          ///< meters, of the patch
  bool counts = true;        ///< false by daylight outside of enclosed spaces, where no accuracy is asked for
};

/// Places in patches drawn with equal probability. Leaves out places behind other polygons of the same plane, and
/// those that readings exclude as inside walls. Returns fewer if the scene has no more.
std::vector<SurfacePlace> draw_surface_places(const Simulation& simulation, std::size_t count, std::uint64_t seed);

/// Irradiances, one row per place and one column per band, W/m^2.
struct PlaceIrradiance {
  Field irradiance;
  Field standard_error;
};

/// The irradiance that final pictures of 3 x 3 pixels show: (pi L - E) / rho. A camera looks at each place from nearby.
/// The result is the mean over `seeds` pictures; their scatter gives the standard error.
PlaceIrradiance picture_irradiance(const Simulation& simulation, std::span<const SurfacePlace> places,
                                   std::uint32_t seeds);

}  // namespace patchlight::test
