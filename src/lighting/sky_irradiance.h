#pragma once

#include "lighting/receiver.h"

namespace patchlight {

/// Mean irradiance of a receiver by sky and ground, W/m^2 per band, over the part of it over which nothing lies. Where
/// the scene has clear openings each sample is two rays, one distributed as the cosine over the hemisphere and one
/// towards a point of an opening, put together by the balance heuristic (Veach and Guibas 1995, eq. 14): what gets in
/// through a window is found by rays to the window, what gets in through a hole by the others.
Spectrum sky_irradiance(const Lighting& lighting, const Receiver& receiver, SamplePoints samples);

}  // namespace patchlight
