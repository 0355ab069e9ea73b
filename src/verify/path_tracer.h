#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/base/progress.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sensor.h"
#include "patchlight/scene/sides.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A flat piece of one side of a polygon; its mean irradiance is computed.
struct PathReceiver {
  std::array<Point, 4> corners;  ///< convex, meters; a triangle repeats its last
  PolygonIndex polygon = 0;
  Side side = Side::front;
};

/// Several receivers as one; their mean irradiance is computed.
struct PathRegion {
  std::vector<PathReceiver> receivers;
};

/// The number of batches of paths, each stratified separately; their scatter gives the standard error.
inline constexpr std::uint32_t path_batches = 32;

/// How many paths are traced.
struct PathOptions {
  std::uint32_t paths = 4096;  ///< per receiver; rounded up to path_batches times a power of two
  std::uint64_t seed = 1;
  bool follows_reflections = true;  ///< light that mirrors and clear faces reflect goes on; else it is absorbed
};

/// One row per receiver, one column per band.
struct PathEstimate {
  Field irradiance;         ///< mean over the exposed part of the receiver, W/m^2; 0 if nothing is
  Field standard_error;     ///< its standard error, W/m^2, estimated with path_batches - 1 degrees of freedom
  std::uint32_t paths = 0;  ///< per receiver
  std::uint64_t rays = 0;   ///< per vertex of a path one to a lamp and one scattered, where there are luminaires one to
                            ///< one of them, and where there is a sun one to it
};

/// Irradiance by path tracing: the rendering equation of Kajiya (1986) for diffuse surfaces, without patches, form
/// factors or a system of equations. The tracer shares the ray caster and the scene with the solver; sources, panes,
/// mirrors and sky are evaluated by code of its own. Kept sides reflect and emit as in simulate(); other sides are
/// black. Shadow rays find luminaires and sun, also over chains of mirrors of any length. Scattered rays find the sky.
/// The mean is over the part of a receiver that is not covered (docs/theory/radiosity-equation.md). The result does not
/// depend on the number of threads. \throws Canceled.
PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const PathReceiver> receivers,
                              const PathOptions& options = {}, const Observer& observer = {});

/// The mean irradiance of regions, from points spread over their exposed area: one row per region. \throws Canceled.
PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const PathRegion> regions,
                              const PathOptions& options = {}, const Observer& observer = {});

/// Irradiance at points, by paths that start at each sensor over the hemisphere of its normal: one row per sensor. A
/// sensor that lies on polygons is read just in front of the sides that it faces along. \throws Canceled.
PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const Sensor> sensors,
                              const PathOptions& options = {}, const Observer& observer = {});

}  // namespace patchlight
