#pragma once

#include "base/sampling.h"
#include "lighting/receiver.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace patchlight {

/// Towards which openings rays go from a receiver.
struct SkyAim {
  Chooser openings;       ///< among Lighting::openings; empty: no rays
  bool at_panes = false;  ///< some of these are clear faces
};

/// The purpose of rays: the mean over a patch, or single points.
enum class AimFor : std::uint8_t { patch, points };

/// Seven of eight rays choose an opening before the receiver in proportion to its apparent_size(). The others choose
/// any alike: so they find slits that are darker than windows which the receiver does not see. Rays are not aimed at
/// holes alone where a few rays see much of the sky without. Neither are they for a patch where a few see no sky
/// through the holes, which may be hidden. A point would so miss the visible rest of a window behind a table's leg,
/// with no error. A point aims at no opening that a single polygon surely hides.
SkyAim sky_aim(const Lighting& lighting, const Receiver& receiver, AimFor what);

/// The openings through which rays have seen the sky.
struct SkySeen {
  std::vector<std::uint8_t> through;  ///< per opening that may be aimed at, 1: a ray got to the sky through it
  std::size_t aimed = 0;              ///< rays towards openings
};

/// A ray that has got to the sky: the number of its set of samples, its direction, and its weight per band, the
/// irradiance of the receiver by a radiance of 1 along it, sr.
using AtSky = std::function<void(std::size_t set, const Vector& direction, const Spectrum& weight)>;

/// The light of the sky that rays find.
struct SkyLight {
  Field irradiance;  ///< a row for each set of samples
  SkySeen seen;
};

/// Mean irradiance of a receiver by sky and ground, W/m^2 per band, over the part of it over which nothing lies. Each
/// set of samples gives an independent estimate: by a ray for each sample, distributed as the cosine over the
/// hemisphere, and others towards openings, put together by the balance heuristic (Veach and Guibas 1995, eq. 14): with
/// clear faces a second one for each of half of the samples, with holes alone one more for each of the first half.
/// Where these are many times as dense they alone count (the cutoff heuristic of the same paper). Only the first kind
/// finds light through a gap that is no opening.
SkyLight sky_irradiance(const Lighting& lighting, const Receiver& receiver, const SkyAim& aim,
                        std::span<const SamplePoints> sets);

/// The rays of sky_irradiance() one by one: the irradiance of a set is the sum of weight times radiance over its rays.
SkySeen visit_sky(const Lighting& lighting, const Receiver& receiver, const SkyAim& aim,
                  std::span<const SamplePoints> sets, const AtSky& at_sky);

/// The light that one ray towards openings would bring to a point, W/m^2: the most, in each band, by any opening
/// through which none of so many has got to the sky. As no hit of n rays means at most a few of n, this is how far off
/// that light may be; as for the shadow rays of sensors, one of them counts (gather.h).
Spectrum missed_sky(const Lighting& lighting, const SurfacePoint& at, const SkyAim& aim, const SkySeen& seen);

}  // namespace patchlight
