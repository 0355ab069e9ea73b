#pragma once

#include "lighting/receiver.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Towards which openings rays go from a receiver.
struct SkyAim {
  std::vector<double> probabilities;  ///< of each of Lighting::openings to be chosen; none: no rays
  bool at_panes = false;              ///< some of these are clear faces
};

/// What rays are for: the mean over a patch, or single points.
enum class AimFor : std::uint8_t { patch, points };

/// Seven of eight rays choose an opening with a probability as the solid angle that it would fill if it were turned to
/// the receiver's middle, roughly, and the others any alike, so that a slit is found whose light windows outshine that
/// the receiver does not see; none behind the receiver. Holes alone are not aimed at where a few rays see much of the
/// sky without, nor for a patch where a few see none of it through the holes, which may be hidden: of a point that
/// would miss what is left in sight of a window behind a table's leg, and no error would tell.
SkyAim sky_aim(const Lighting& lighting, const Receiver& receiver, AimFor what);

/// What of the sky rays have seen.
struct SkySeen {
  std::vector<std::uint8_t> through;  ///< per opening that may be aimed at, 1: a ray got to the sky through it
  std::size_t aimed = 0;              ///< rays towards openings
};

/// What rays find of the sky.
struct SkyLight {
  Spectrum irradiance;
  SkySeen seen;
};

/// Mean irradiance of a receiver by sky and ground, W/m^2 per band, over the part of it over which nothing lies: by a
/// ray for each sample, distributed as the cosine over the hemisphere, and others towards openings, put together by the
/// balance heuristic (Veach and Guibas 1995, eq. 14): with clear faces a second one for each of half of the samples,
/// with holes alone one more for each of the first half. Where these are many times as dense they alone count (the
/// cutoff heuristic of the same paper). What gets in through a gap that is no opening is found by the
/// first kind alone.
SkyLight sky_irradiance(const Lighting& lighting, const Receiver& receiver, const SkyAim& aim, SamplePoints samples);

/// What one ray towards openings would bring to a point, W/m^2: the most, in each band, by any opening through which
/// none of so many has got to the sky. As no hit of n rays means at most a few of n, this is how far off that light may
/// be; as for the shadow rays of sensors, one of them counts (gather.h).
Spectrum missed_sky(const Lighting& lighting, const SurfacePoint& at, const SkyAim& aim, const SkySeen& seen);

}  // namespace patchlight
