#pragma once

#include "patchlight/accuracy/error_bars.h"
#include "patchlight/base/field.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/lost_share.h"
#include "patchlight/transport/transport_operator.h"

#include "mesh/nested_mesh.h"
#include "solve/scattering.h"
#include "transport/ray_transport.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A few bands of a field of which the others are combinations: the light of one lamp on some paints has far fewer
/// degrees of freedom than bands.
struct SpanningBands {
  std::vector<Eigen::Index> bands;  ///< of the field
  Eigen::MatrixXd weights;          ///< a column for each band of the field, a row for each of `bands`

  /// True when every band is its own.
  bool spans_all() const { return weights.rows() == weights.cols(); }
  /// The columns of `bands`.
  Field of(const FieldView& field) const;
  /// All bands of a quantity that depends linearly on the field, from its values in `bands`.
  Field all_bands(const FieldView& in_bands) const;
};

/// Enough bands that every one is a combination of theirs but for `tolerance` of its norm, sqrt(sum_i A_i x_i^2). Up to
/// three bands stay as they are. Bands in which all is 0 take none. The same bits for any number of threads.
SpanningBands spanning_bands(const FieldView& field, const Eigen::VectorXd& area, double tolerance);

/// Such bars as one figure: ||R bar||_A / ||B - E||_A, the worst band; infinite where there is an error
/// and no reflected light. Patches of weight 0 do not count.
double relative_bar(const FieldView& bar, const RadiosityProblem& problem, const Solution& solution,
                    const Eigen::VectorXd& weight);

/// A problem and its solution.
struct SolvedProblem {
  const RadiosityProblem& problem;
  const Solution& solution;
  bool closed = false;  ///< nothing gets lost: rows of the transport sum up to 1
};

/// A solved problem in the bands that solved_bands() names. Quantities that are linear in the light differ in the other
/// bands by a factor only.
struct InNeededBands {
  SolvedBands bands;
  RadiosityProblem problem;
  Solution solution;  ///< without directs, ambient and error

  SolvedProblem solved() const { return {problem, solution}; }
};

InNeededBands in_needed_bands(const SolvedProblem& solved);

/// An error of the irradiance, W/m^2, followed through all reflections: e = irradiance + F R e, to 5 % of the reflected
/// part in each band. Of many bands some are solved, and others are combinations of them where these are as good.
Field followed(const TransportOperator& transport, const RadiosityProblem& problem, const Field& irradiance);

/// The mean over draws of their squares, per patch and band.
Field mean_square(std::span<const Field> draws);

/// Equally likely errors of the irradiance by sampled form factors, of the light `B`, radiosity in W/m^2. Each draws
/// errors of the entries (random_errors()) and follows them: e = A^-1 D B + F R e. In a closed scene the draws are
/// closed as the matrix was, so that rows keep their sums. docs/theory/error-estimation.md. Costs some tens of
/// applications. `raw` has the errors of the entries.
std::vector<Field> draw_form_factor_errors(const PatchMesh& mesh, const Assembly& raw, const RowTransport& transport,
                                           const SolvedProblem& solved, const FieldView& B);

/// The error of light straight from the lamps, where that was found a second time, with other samples: `difference`, in
/// W/m^2, is how far both are apart.
Field direct_light_errors(const PatchMesh& mesh, const RowTransport& transport, const RadiosityProblem& problem,
                          const FieldView& difference);

/// Equally likely errors of the irradiance by those of light straight from luminaires, sun and sky: as many draws, the
/// errors of patches independent of each other, each followed; W/m^2. `standard_error` is that of
/// RadiosityProblem::direct_irradiance. Costs some tens of applications, none where it is 0.
std::vector<Field> draw_errors_of_lights(const PatchMesh& mesh, const RowTransport& transport,
                                         const RadiosityProblem& problem, const Field& standard_error);

/// The error of the exposed share of a patch, when it is not all of it, as a share of it; stratified points
/// find a straight edge with a variance of their number to the power of -3/2 times the length of the edge, which grows
/// as the root of covered (1 - covered).
Eigen::ArrayXd exposure_errors(const LostShare& lost);

/// The error of the mean irradiance by the size of the patches, by Richardson's extrapolation from sources twice as
/// large: |F (B_h - B_2h)| / (2^order - 1), where B_2h is the solution on the parents, with the same exchange areas
/// summed up. Of that and its root mean square over the patches around, the larger: where the difference changes sign,
/// it is not the error that is 0.
Field mesh_errors(const NestedMesh& mesh, const RowTransport& transport, const SolvedProblem& solved,
                  const FieldView& radiosity_of_parents);

/// The order of the mean irradiance in the size of the patches that mesh_errors() takes. Measured ones are 1.5 to 2
/// where there are no shadow edges, docs/theory/edges-and-contacts.md; with 1.2 bars in rooms with furniture cover what
/// they should.
inline constexpr double mesh_order = 1.2;

/// The factor of the errors of light straight from the lamps, known from a single difference, so that bars cover
/// enough.
inline constexpr double form_factor_scale = 1.5;

/// Lamps that are a larger share of the patches are not told apart from other light when errors are looked for: rays
/// find them as well.
inline constexpr double most_lamps = 0.125;

/// How far the radiosity of the lit part of a patch that reaches into a solid is above its mean: B_i d_i / (1 - d_i),
/// d_i the dark share, not above 1/2. As long as the patch is wider than what is dark of it, the light that this takes
/// away does not depend on the patch's size: comparison with larger patches does not show it.
Field dark_differences(const LostShare& lost, const SolvedProblem& solved);

/// The error in gaps narrower than their patches. Comparison with larger patches does not show it: light from the rim
/// spreads over a whole patch. It is (s - 0.35) / (1 - 0.35) min(H_i, D_i) / 2, or 0
/// where s < 0.35. s is the share of the hemisphere of faces that look back from nearer than 0.6 edges; one face at
/// that distance takes 0.35. D_i is the range of radiosities that the patch sees plus its direct light: the irradiance
/// by sources of one radiosity is right. The factor 1/2 is measured. `S` in m^2. O(size^2).
Field gap_errors(const PatchMesh& mesh, const ExchangeAreas& S, const SolvedProblem& solved);

/// The same by rows of rays, after `cuts` cuts of each patch. O(rays).
Field gap_errors(const PatchMesh& mesh, const RayTransport& transport, const SolvedProblem& solved, int cuts = 0);

/// How far points of a patch are from its mean: from the differences between the patches of a parent, which are
/// sqrt(3) of those inside a patch where the irradiance is linear.
Field display_errors(const NestedMesh& mesh, const SolvedProblem& solved);

/// The solver's bound |dB_i| / rho_i; for patches that reflect nothing the largest of the others. Infinite where none
/// is known.
Field solver_errors(const SolvedProblem& solved);

/// The problem for the parents of a mesh.
RadiosityProblem problem_of_parents(const NestedMesh& mesh, const RadiosityProblem& problem);

/// The counterpart of mesh_errors() for rows of rays: F (B_h - B_2h), where B_2h = E + R P F B_2h is the solution on
/// the parents, P the mean over each. B_h - B_2h = (1 - P) B + R e, where the mean irradiance of parents is off by
/// e = P F (1 - P) B + P F R e: how the light of a parent's patches differs is known to the patches, and is in the
/// error only as far as it gets to other parents. So the error of the irradiance of each patch, W/m^2, is F (1 - P) B +
/// F R e by Richardson's extrapolation. Twice, F (1 - P) B by either half of the rays: the product has little bias by
/// their noise, and its mean over the patches around has less of it; of both the larger, as in mesh_errors(). Zero
/// where no parent is cut.
Field errors_within_parents(const NestedMesh& mesh, const RayTransport& transport, const SolvedProblem& solved);

}  // namespace patchlight
