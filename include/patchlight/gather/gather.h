#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/sensor.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

class LightPaths;
class SpecularAim;
class Occluder;

/// Errors of the gathered radiosities, per patch and band, W/m^2. Empty fields count as zero.
struct RadiosityErrors {
  Field sampling;                      ///< standard deviations of errors that are independent of each other
  std::vector<Field> correlated = {};  ///< equally likely draws of the sampling errors shared by patches
  Field mesh;                          ///< standard deviations of errors that patches share; empty where not known
  Field solver;                        ///< bounds
  Field display;    ///< root mean square deviation of points of a patch from its mean; empty if unknown
  Field reflected;  ///< radiosity without exitance: its error is estimated if `mesh` is unknown
};

/// Irradiance at sensors (rows) that is not gathered, and its standard error, W/m^2.
struct OtherIrradiance {
  Field mean;
  Field standard_error;
};

/// How the light at sensors is sampled.
struct GatherOptions {
  int least_rays = 4;       ///< shadow rays to a bright patch before the sensor, unless these are too many
  int rays = 4096;          ///< to bright patches, in proportion to their possible light; as many over the hemisphere,
                            ///< and as many towards clear faces and mirrors
  int most_rays = 1 << 18;  ///< if the relative standard error is above wanted_error
  double wanted_error = 0.01;  ///< requested standard error of a sensor, relative to all of its light
  std::uint64_t seed = 1;
  bool slopes = true;  ///< light varies along patches; else each is even, and readings are linear in radiosity
  RadiosityErrors errors = {};
  const LightPaths* paths = nullptr;       ///< the sensors' clear faces and mirrors; null: those of the occluder
  const SpecularAim* aim = nullptr;        ///< aims rays at these faces; null: rays find them by chance
  const Field* mirrored_light = nullptr;   ///< the radiosity that mirrors show; null: all of it
  const OtherIrradiance* other = nullptr;  ///< decides the number of rays, and is not added; null: none
};

/// Standard errors of irradiances by source, W/m^2.
struct SensorErrors {
  Field rays;      ///< rays from the sensor
  Field sampling;  ///< of the sampled light that patches reflect
  Field mesh;      ///< from the linear light on each patch, and the errors of the patches
  Field solver;    ///< a bound

  /// The root of the sum of squares.
  Field total() const;
};

/// Irradiance at points (rows) per band (columns), W/m^2.
struct GatheredIrradiance {
  Field irradiance;
  SensorErrors errors;
};

/// Computes irradiance at points by gathering the solved radiosity, in two parts. Columns are the bands of the scene,
/// or any number of radiosities if no clear face or mirror has a color.
/// - Bright patches: their radiosity exceeds twice the irradiance that a few first rays find at the sensor. Each
///   contributes its closed-form form factor times its visible fraction by shadow rays. The number of rays depends on
///   its unoccluded light, not on hits, so the estimate keeps all light through narrow openings. Patches that a single
///   polygon surely hides get none. If there are very many, some are chosen at random.
/// - All others: by rays over the hemisphere, distributed as the cosine. They continue through clear faces and mirrors.
///   Bright patches count in mirrors only.
/// In a mesh of at most rays / least_rays patches all count as bright, so that sensors without occluders are exact.
///
/// Rays form replicates with independent random shifts, whose scatter gives the standard error. Its lower bound is the
/// heaviest ray of those bright patches whose rays agree, as no hit in n rays means at most a few in n. Sensors with
/// too large a standard error get more rays, in proportion to its square, but none to make it smaller than a seventh of
/// the sensor's other errors. The random numbers depend on the place of the sensor.
///
/// On each patch the radiosity is linear, with slopes fitted to the means of surrounding patches. The nonlinear part is
/// an error, weighted by how unevenly the sensor sees the patch, docs/theory/irradiance-at-a-point.md. Such errors of
/// patches add up in squares. If `display` is unknown, all reflected light of a polygon side with four patches or fewer
/// is such an error, as symmetry may make these patches alike.
///
/// The errors of the patches are gathered like their light. Independent sampling errors add up in squares. Each draw of
/// correlated errors adds up like light. Mesh errors and the solver's bounds add up linearly. If the mesh errors of the
/// patches are unknown, the relative error of the reflected light is estimated from the residual of the planes, root
/// mean square over all sensors. O(points x (rays + patches)), with little work per patch. \throws Canceled.
GatheredIrradiance gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const Occluder& occluder,
                                     std::span<const Sensor> sensors, const GatherOptions& options = {},
                                     const Observer& observer = {});

}  // namespace patchlight
