#pragma once

#include "patchlight/simulate.h"

#include <cstdint>

namespace patchlight {

/// Of n paths that met no light the bound of 95 % on the share that would have is 3 / n (Hanley and Lippman-Hand 1983).
inline constexpr double bound_of_none = 3;

/// What three of so many paths bring, W/m^2: each the radiosity at which light is reflected that comes straight from
/// lamps, the mean over that light. Light that few paths meet, as that of the pool of a narrow spot, is missed by most
/// of the batches or by all, so that their scatter tells too little of it. Of c paths that meet it where k were to be
/// expected, (c - k) / sqrt(c + 3^2) has no longer tails than a normal deviate, for any k. The lights are those of
/// `scene`. How uneven light is within patches is looked at where most of it falls.
Spectrum few_paths_error(const Scene& scene, const Simulation& simulation, std::uint32_t paths);

}  // namespace patchlight
