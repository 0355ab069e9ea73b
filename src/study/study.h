#pragma once

#include "patchlight/simulate.h"

#include "study/reference.h"

#include <limits>
#include <string>
#include <vector>

namespace patchlight {

/// One way of solving a scene: what it costs and how good it is. Errors are shares of the reflected light, NaN where
/// they are not known.
struct StudySetting {
  PatchIndex patches = 0;
  Estimator estimator = Estimator::automatic;
  int samples = 0;       ///< shadow rays of a partly occluded pair
  double tolerance = 0;  ///< of the solver
  std::vector<StageCost> costs;
  double matrix_bytes = 0;   ///< of the stored form factors: what grows with the square of the patches
  double error = 0;          ///< of the patch means, against the reference
  double display_error = 0;  ///< of the field that is constant on each patch
  double own_error = 0;      ///< due to the swept quantity alone: against the same with the finest value of it
  double order = std::numeric_limits<double>::quiet_NaN();  ///< observed, from the setting before it to this one
  bool on_time_front = false;    ///< no setting that competes is better for as many CPU seconds or fewer
  bool on_memory_front = false;  ///< nor for as many bytes or fewer
};

/// The setting with its errors against the reference. Its own error is that of the patch means, too.
StudySetting judged(const Simulation& simulation, const Reference& reference);

/// The setting with an own error that is due to one quantity alone: against radiosities `own` on the same mesh.
StudySetting judged(const Simulation& simulation, const Reference& reference, const FieldView& own);

/// What a sweep changes. The order of a sweep is the power with which its own error falls with the edge of the patches,
/// the reciprocal of the number of samples, and the tolerance.
enum class Swept { patch_size, samples, tolerance };

/// Settings that differ in one quantity.
struct StudySweep {
  std::string name;
  Swept swept = Swept::patch_size;
  std::vector<StudySetting> settings;  ///< from coarse to fine
  bool competes = true;                ///< its settings are for use: they take part in fronts and prices
};

/// Where the error of the finest setting comes from: three parts, which add up in quadrature.
struct ErrorParts {
  double mesh = 0;
  double form_factors = 0;
  double solver = 0;
  std::string worst_place;  ///< the object, or the material of a model without objects, with the largest squared error
  double worst_share = 0;   ///< its share of the squared error
};

/// The reference of a study.
struct StudyReference {
  bool closed_form = false;  ///< the furnace: nothing was computed
  PatchIndex patches = 0;
  PatchIndex uniform_patches = 0;  ///< before it was cut where adaptive meshes are finer
  int samples = 0;
  double bar = 0;  ///< its own error, by Richardson's extrapolation from two coarser ones: what is below is not known
  double cpu_seconds = 0;
  bool converged = true;
};

/// What accuracy costs.
struct Study {
  Plan plan;          ///< of the finest setting of the sweeps
  Diagnostics notes;  ///< of its run
  StudyReference reference;
  std::vector<StudySweep> sweeps;
  ErrorParts parts;
  std::string trapped;  ///< why there is no solution, and nothing else here; else empty
};

/// How much a study tries.
struct StudyOptions {
  int sizes = 4;           ///< of patches at most: longest edges are halved, so patches times four
  bool adaptive = true;    ///< solve to accuracies as well, with patches that are refined where it pays
  bool estimators = true;  ///< compare them, on a small mesh
};

/// \throws InputError when the request cannot be studied.
void check_for_study(const Request& request);

/// Solves a scene in many ways, one quantity changed at a time from the setting that `request` asks for: patches from
/// coarser ones up to its number, with its samples and with four times as many, samples around its number, tolerances
/// down to its own; and the estimators of form factors on a small mesh, on which they do not compete. The reference is
/// the closed form where there is one (a closed room with E = 1 - rho), else a solution with half the edges of the
/// finest size and, wherever adaptive meshes are, with a quarter of their patches' area, and four times the samples.
/// \throws InputError, MemoryError when the reference does not fit, Cancelled.
Study study(const Scene& scene, const Request& request, const StudyOptions& options = {},
            const Observer& observer = {});

/// Wall-clock and processor seconds from the mesh to the solution.
double seconds_of(const StudySetting& setting);
double cpu_seconds_of(const StudySetting& setting);

}  // namespace patchlight
