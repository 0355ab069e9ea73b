#pragma once

#include "patchlight/simulate.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// A mesh of which no edge is longer.
struct SizedMesh {
  double max_edge = 0;  ///< meters
  PatchMesh mesh;
};

/// Nested meshes, each cut from the previous one, so that means over their patches are exact sums of patches of the
/// last one. Patches of a reference that cross the edge of another patch would add an error of about their size. Each
/// step halves the longest edges and gives about four times the patches. A mesh with more than half the patches of the
/// next one is left out.
struct NestedSizes {
  std::vector<SizedMesh> sizes;  ///< from coarse to fine; the last one is about what the request asks for
  SizedMesh finer;               ///< with half the edges
  double coarsest_edge = 0;      ///< with which the scene is tessellated; meters
};

/// `sizes` sizes at most. \throws MemoryError when the finer mesh would not fit.
NestedSizes nested_sizes(const Scene& scene, const Request& request, int sizes);

/// The mesh, cut until a patch has at most a quarter of the area of the patch of `other` at its center. Both are cut
/// from one tessellation, so each patch lies in one patch of `other`.
PatchMesh finer_than(PatchMesh mesh, const PatchMesh& other);

/// The reference for the errors of a solution.
struct Reference {
  std::optional<Spectrum> uniform;  ///< the closed form: the radiosity of every patch, W/m^2
  PatchMesh mesh;                   ///< where there is none: a finer solution, constant on each of its patches
  RadiosityProblem problem;
  Field radiosity;  ///< W/m^2
};

/// A finer solution of the same scene and sides.
Reference reference_from(const Simulation& finer);

/// The radiosity c that every patch would have in a closed room, where E = c (1 - rho) on all of them (the furnace): B
/// = c (1 - rho) + rho c. Nothing where that does not hold within 1e-9 of c. Whether the room is closed is for the
/// caller to see.
std::optional<Spectrum> furnace_radiosity(const RadiosityProblem& problem);

/// How far a solution is from the reference, as shares of the norm of the reflected light ||B_ref - E||_A, in the worst
/// band.
struct Discrepancy {
  double of_means = 0;    ///< of the means over its patches: relative_error()
  double of_display = 0;  ///< of the field that is constant on each patch: with the spread of the reference within them
  Eigen::VectorXd squares;  ///< per patch, of_means^2 is their sum
};

/// The spread within a patch that the reference, n_ref patches itself, cannot show is made up for: fields vary about
/// linearly in a patch, so that it sees 1 - n / n_ref of the squares.
Discrepancy discrepancy(const Simulation& simulation, const Reference& reference);

/// One way of solving a scene, with its cost and its errors. Errors are fractions of the reflected light, NaN where
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
  bool on_time_front = false;    ///< no setting that competes is better in the same CPU time or less
  bool on_memory_front = false;  ///< nor for as many bytes or fewer
};

/// The setting with its errors against the reference. Its own error is that of the patch means, too.
StudySetting judged(const Simulation& simulation, const Reference& reference);

/// The setting with an own error that is due to one quantity alone: against radiosities `own` on the same mesh.
StudySetting judged(const Simulation& simulation, const Reference& reference, const FieldView& own);

/// The quantity that a sweep changes. The order of a sweep is the power with which its own error falls: with the edge
/// of the patches, the reciprocal of the number of samples, or the tolerance.
enum class Swept { patch_size, samples, tolerance };

/// Settings that differ in one quantity.
struct StudySweep {
  std::string name;
  Swept swept = Swept::patch_size;
  std::vector<StudySetting> settings;  ///< from coarse to fine
  bool competes = true;                ///< fronts and prices include its settings
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
  double bar = 0;  ///< its own error, by Richardson extrapolation from two coarser ones; smaller errors are unknown
  double cpu_seconds = 0;
  bool converged = true;
};

/// The cost of accuracy.
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

/// Solves a scene in many ways, changing one quantity at a time from the setting of `request`:
/// - patches from coarser ones up to its number, with its samples and with four times as many;
/// - samples around its number;
/// - tolerances down to its own;
/// - the estimators of form factors on a small mesh, which do not compete.
/// The reference is the closed form where there is one: a closed room with E = 1 - rho. Otherwise: a solution with half
/// the edges of the finest size, a quarter of the patch area of adaptive meshes, and four times the samples.
/// \throws InputError, Canceled, MemoryError if the reference does not fit.
Study study(const Scene& scene, const Request& request, const StudyOptions& options = {},
            const Observer& observer = {});

/// Wall-clock and processor seconds from the mesh to the solution.
double seconds_of(const StudySetting& setting);
double cpu_seconds_of(const StudySetting& setting);

/// The power p with which an error falls with the edge of the patches: e1 / e2 = (h1 / h2)^p from `coarse` to `fine`.
/// The reference has `reference_patches`, infinite for the exact solution. NaN if the errors do not fall, or if the
/// edges of `fine` are less than four times as long as those of the reference.
double order_in_edge(const StudySetting& coarse, const StudySetting& fine, double reference_patches);

/// The sweep with its orders filled in.
StudySweep with_orders(StudySweep sweep, double reference_patches);

/// The error of a reference: Richardson's extrapolation from its difference to the finest setting of a sweep of
/// patches. The order is the observed one, at least 1/2 and at most 2: from plain ratios of errors where two settings
/// are far coarser than the reference, else with the error of the reference in the model.
double richardson_bar(const StudySweep& by_size, double reference_patches);

/// The number of patches that its mesh has at least the fineness of a uniform one of; infinite for the closed form.
double patches_of(const StudyReference& reference);

/// Which of some points (cost, error) are on the Pareto front: no other one is at least as good in both and better in
/// one.
std::vector<bool> pareto_front(const std::vector<std::array<double, 2>>& points);

/// The study with the fronts of all settings that compete marked.
Study with_fronts(Study study);

/// How a price was found.
enum class Finding {
  interpolated,  ///< between two settings of the front, in logarithms
  at_most,       ///< the cheapest setting is good enough
  extrapolated,  ///< beyond the finest mesh, by the observed order, no farther than 16 times its patches
  not_reached,   ///< farther, or no order is known
  not_known      ///< the reference's own error is as large
};

/// The cost of an error.
struct Price {
  double error = 0;  ///< requested
  Finding finding = Finding::not_reached;
  double cpu_seconds = 0;
  double order = 0;  ///< by which it was extrapolated
};

/// The reference's bar counts as part of every error.
Price price_of(double error, const Study& study);

/// The study in a sentence: "1 % costs 2.1 s of CPU time here, ...; the largest error comes from ...".
std::string conclusion(const Study& study);

}  // namespace patchlight
