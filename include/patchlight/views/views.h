#pragma once

#include "patchlight/base/field.h"
#include "patchlight/gather/readings.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// The readings of sensors in a solved scene.
struct SensorView {
  Readings readings;
  Diagnostics warnings;  ///< a sentence for each sensor at a doubtful place
};

/// Reads the sensors of a solved scene at their places: light gathered from its patches, and straight from
/// luminaires, sun and sky. `simulation` comes from simulate(). \throws Canceled.
SensorView read_sensors(const Simulation& simulation, const Observer& observer = {});

/// The same for sensors at other places.
SensorView read_sensors(const Simulation& simulation, const std::vector<SensorGroup>& sensors,
                        const Observer& observer = {});

/// True when sensors have daylight factors: all light comes from a CIE overcast sky.
bool has_daylight_factors(const Scene& scene);

/// The surface of a solved scene, for output. It refers to the simulation, which must outlive it.
struct SolvedSurface {
  const Scene& scene;  ///< as read
  const Simulation& simulation;
  Field radiance_at_vertices;              ///< the smoothed radiance at the mesh's vertices, W/(m^2 sr)
  Eigen::VectorXd ambient_occlusion = {};  ///< per patch: the share of the hemisphere, weighted by the cosine, in which
                                           ///< nothing lies within a distance; empty: not asked for
  Eigen::VectorXd ambient_occlusion_at_vertices = {};  ///< smoothed
};

/// Smooths the radiance of a solution by rays along the patches. With a distance in meters, it also computes ambient
/// occlusion. `simulation` comes from simulate().
SolvedSurface surface_of(const Simulation& simulation, const std::optional<double>& ambient_distance = {});

/// The light for an observer at a camera's eye who looks at its target.
struct ObserverReading {
  std::string name;                    ///< the camera's
  double vertical_illuminance = 0;     ///< at the eye, on the plane across the line of sight, lx
  double cylindrical_illuminance = 0;  ///< the mean on all upright planes at the eye, lx
  double background_luminance = 0;  ///< of CIE 117: irradiance of that plane by all but the sources of glare, over pi
  double glare_solid_angle = 0;     ///< of those sources, sr
  std::optional<double> unified_glare_rating = {};  ///< CIE 117:1995; nothing without sources or background
};

/// The readings of observers in a solved scene. Sources of glare are windows and surfaces brighter than 500 cd/m^2 and
/// than four times the mean of the visible half space. Measured luminaires glare by the sides of their luminous
/// openings, with the luminance I / A_p. Lamps without extent give light, but no glare. \throws Canceled.
std::vector<ObserverReading> read_observers(const Simulation& simulation, const std::vector<Camera>& cameras,
                                            const Observer& observer = {});

}  // namespace patchlight
