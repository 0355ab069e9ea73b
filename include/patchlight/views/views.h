#pragma once

#include "patchlight/base/field.h"
#include "patchlight/gather/readings.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include <optional>
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

/// The surface of a solved scene, ready to be written. It refers to its scene and simulation, which must outlive it.
struct SolvedSurface {
  const Scene& scene;
  const Simulation& simulation;
  Field radiance_at_vertices;              ///< the smoothed radiance at the mesh's vertices, W/(m^2 sr)
  Eigen::VectorXd ambient_occlusion = {};  ///< per patch: the share of the hemisphere, weighted by the cosine, in which
                                           ///< nothing lies within a distance; empty: not asked for
  Eigen::VectorXd ambient_occlusion_at_vertices = {};  ///< smoothed
};

/// Smooths the radiance of a solution, which traces rays along the patches, and with a distance in metres finds its
/// ambient occlusion. `scene` is the one that was solved, and `simulation` comes from simulate().
SolvedSurface surface_of(const Scene& scene, const Simulation& simulation,
                         const std::optional<double>& ambient_distance = {});

}  // namespace patchlight
