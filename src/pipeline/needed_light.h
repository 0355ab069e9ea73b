#pragma once

#include "patchlight/solve/solve.h"

#include "pipeline/exchange_and_light.h"
#include "solve/scattering.h"

namespace patchlight {

/// What is solved with rows of rays, in the bands that need it: the light of each other band, and its errors, are those
/// of one of these times a factor.
struct NeededLight {
  SolvedBands bands;
  RadiosityProblem problem;  ///< of what the rows carry: exitance without lamps apart, whose light is direct
  Field of_lamps;            ///< variance of the irradiance by lamps apart, (W/m^2)^2
  Field of_others;           ///< of that by luminaires, sun, sky and mirrors; empty where there is none
};

/// All bands where each is to be solved, SolverOptions::every_band or with a reference.
NeededLight needed_light(const RayLight& light, const SolverOptions& options);

}  // namespace patchlight
