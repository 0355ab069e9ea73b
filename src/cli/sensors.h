#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/gather/sensor_places.h"
#include "patchlight/simulate.h"

#include "cli/arguments.h"

#include <span>

namespace patchlight::cli {

/// Adds the points of --points to the sensors of the scene. \throws InputError.
Scene with_points(Scene scene, const SolveArguments& arguments);

/// Where readings are written: what the arguments name, else their default where the scene has sensors. \throws
/// InputError when an output is named but nothing is to be read.
std::vector<std::filesystem::path> points_outputs(const SolveArguments& arguments, const Scene& scene);

/// What the sensors of a solved scene read at their places: light gathered from its patches, and straight from
/// luminaires, sun and sky. \throws Cancelled.
Readings read_sensors(const Scene& scene, const Simulation& simulation, std::span<const SensorPlace> places,
                      const Observer& observer);

}  // namespace patchlight::cli
