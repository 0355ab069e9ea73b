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
class Occluder;

/// Errors of the radiosities that are gathered, per patch and band, W/m^2. Empty fields: none.
struct RadiosityErrors {
  Field sampling;                      ///< standard deviations of errors that are independent of each other
  std::vector<Field> correlated = {};  ///< equally likely draws of the sampling errors that patches have in common
  Field mesh;                          ///< standard deviations of errors that patches share; empty where not known
  Field solver;                        ///< bounds
  Field display;    ///< root mean square of how far points of a patch are from its mean; empty where not known
  Field reflected;  ///< radiosity without exitance: where `mesh` is not known, the part of it that may be off
};

/// How the light at sensors is sampled.
struct GatherOptions {
  int least_rays = 4;          ///< shadow rays to a patch before the sensor
  int rays = 8192;             ///< more of them to all patches together, in proportion to what patches may give
  int most_rays = 1 << 18;     ///< where these leave more than the following relative standard error
  double wanted_error = 0.01;  ///< relative standard error of a sensor
  std::uint64_t seed = 1;
  bool slopes = true;  ///< light varies along patches; else each is even, and readings are linear in radiosity
  RadiosityErrors errors = {};
  const LightPaths* coloured = nullptr;  ///< what each band meets on its way; null where all meet the same
};

/// Standard errors of irradiances by where they come from, W/m^2.
struct SensorErrors {
  Field rays;      ///< shadow rays from the sensor
  Field sampling;  ///< what patches reflect of light that was sampled
  Field mesh;      ///< that light was taken to be a plane on each patch, and the patches' own
  Field solver;    ///< a bound

  /// The root of the sum of their squares.
  Field total() const;
};

/// Irradiance at points (rows) per band (columns), W/m^2.
struct GatheredIrradiance {
  Field irradiance;
  SensorErrors errors;
};

/// Irradiance at points by gathering the solved radiosity: every patch by its closed-form form factor times the share
/// of it that shadow rays reach. How many rays a patch gets follows from its unoccluded light, and not from the hits of
/// its rays: where few of them get through narrow openings, none of the light is lost. The rays of a patch come in
/// replicates with random shifts of their own, whose scatter is the standard error; it is at least what the heaviest
/// ray would give of those patches whose rays agree, as no hit in n rays means at most a few in n. Sensors of which the
/// standard error is too large get more rays, in proportion to its square. The random numbers follow from the sensor's
/// place.
///
/// On each patch the radiosity is a plane, its slopes fitted to the means of the patches around: above a patch that is
/// bright in its middle less is read off its dark corners. The light that a plane does not explain is an error, by as
/// much as the sensor sees the patch unevenly, docs/theory/irradiance-at-a-point.md. Such errors of patches add up in
/// squares. If a polygon side has four patches or fewer, which symmetry may make alike, all that they reflect is one
/// where `display` is not known.
///
/// The patches' own errors are gathered as their light is. Independent sampling errors add up in squares, and each draw
/// of correlated ones as light does; mesh errors and the solver's bounds add up as they are. Where the mesh errors
/// of the patches are not known, the relative error of the reflected light is estimated: the residual of the planes,
/// root mean square over all sensors. O(points x patches). \throws Cancelled.
GatheredIrradiance gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const Occluder& occluder,
                                     std::span<const Sensor> sensors, const GatherOptions& options = {},
                                     const Observer& observer = {});

}  // namespace patchlight
