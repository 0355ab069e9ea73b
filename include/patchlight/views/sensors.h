#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/simulate.h"

#include <string>
#include <vector>

namespace patchlight {

/// What the sensors of a solved scene read.
struct SensorView {
  Readings readings;
  std::vector<std::string> warnings;  ///< a sentence for each sensor whose place is in doubt
};

/// What the sensors of a solved scene read at their places: light gathered from its patches, and straight from
/// luminaires, sun and sky. `scene` is the one that was solved, and `simulation` comes from simulate(). \throws
/// Cancelled.
SensorView read_sensors(const Scene& scene, const Simulation& simulation, const Observer& observer = {});

}  // namespace patchlight
