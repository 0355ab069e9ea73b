#pragma once

#include "patchlight/accuracy/error_bars.h"
#include "patchlight/base/field.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/half_differences.h"
#include "patchlight/transport/lost_share.h"
#include "patchlight/transport/transport_operator.h"

#include "mesh/nested_mesh.h"
#include "solve/scattering.h"
#include "transport/ray_transport.h"

#include <Eigen/Core>
#include <span>
#include <vector>

namespace patchlight {

/// A few bands of a field that span the others. The light of one lamp on a few paints has far fewer degrees of freedom
/// than bands.
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

/// Chooses bands such that every band is a combination of them up to `tolerance` of its norm, sqrt(sum_i A_i x_i^2). Up
/// to three bands stay as they are. Bands that are all 0 need none. The same bits for any number of threads.
SpanningBands spanning_bands(const FieldView& field, const Eigen::VectorXd& area, double tolerance);

/// Summarizes error bars in one number:
///
/// R bar
///
/// _A /
///
/// B - E
///
/// _A, the worst band. Infinite if there is an error but no reflected light. Patches of weight 0 do not count.
double relative_bar(const FieldView& bar, const RadiosityProblem& problem, const Solution& solution,
                    const Eigen::VectorXd& weight);

/// A problem and its solution.
struct SolvedProblem {
  const RadiosityProblem& problem;
  const Solution& solution;
  bool closed = false;  ///< no light is lost: rows of the transport sum to 1
};

/// A solved problem in the bands of solved_bands(). Quantities that are linear in the light differ in the other bands
/// by a factor only.
struct InNeededBands {
  SolvedBands bands;
  RadiosityProblem problem;
  Solution solution;  ///< without directs, ambient and error

  SolvedProblem solved() const { return {problem, solution}; }
};

InNeededBands in_needed_bands(const SolvedProblem& solved);

/// Propagates an error of the irradiance, W/m^2, through all reflections: e = irradiance + F R e, to 5 % of the
/// reflected part in each band. With many bands only some are solved, and the others are combinations of them if these
/// are accurate enough.
Field followed(const TransportOperator& transport, const RadiosityProblem& problem, const Field& irradiance);
/// The same for several irradiances; those of few bands share each pass over the rows.
std::vector<Field> followed(const TransportOperator& transport, const RadiosityProblem& problem,
                            std::vector<Field> irradiances);

/// The mean of the squares over draws, per patch and band.
Field mean_square(std::span<const Field> draws);

/// Random draws of the irradiance error by sampled form factors, W/m^2. Each draws errors of the entries
/// (random_errors()) and propagates them: e = A^-1 D B + F R e. In a closed scene the draws are closed like the matrix,
/// so that rows keep their sums. docs/theory/error-estimation.md. Costs a few tens of applications.
std::vector<Field> draw_form_factor_errors(const HalfDifferences& differences, const RowTransport& transport,
                                           const SolvedProblem& solved);

/// Random draws of the irradiance error by sampled direct light of luminaires, sun and sky, each propagated, W/m^2.
/// Errors of patches are independent. `standard_error` is that of RadiosityProblem::direct_irradiance. Costs a few tens
/// of applications, none where it is 0.
std::vector<Field> draw_errors_of_lights(const PatchMesh& mesh, const RowTransport& transport,
                                         const RadiosityProblem& problem, const Field& standard_error);

/// The relative error of the exposed share of a patch, if it is below 1. For a straight edge, n stratified points have
/// a variance of n^(-3/2) times the length of the edge, which grows as the root of covered (1 - covered).
Eigen::ArrayXd exposure_errors(const LostShare& lost);

/// The discretization error of the mean irradiance, by Richardson extrapolation from sources twice as large: |F (B_h -
/// B_2h)| / (2^order - 1). B_2h is the solution on the parents, with the same exchange areas summed. Returns the larger
/// of this and its root mean square over nearby patches: where the difference changes sign, the error is not 0.
Field mesh_errors(const NestedMesh& mesh, const RowTransport& transport, const SolvedProblem& solved,
                  const FieldView& radiosity_of_parents);

/// The order of convergence that mesh_errors() assumes for the mean irradiance. Measured orders are 1.5 to 2 without
/// shadow edges, docs/theory/edges-and-contacts.md. With 1.2, error bars in furnished rooms cover the true error as
/// often as they should.
inline constexpr double mesh_order = 1.2;

/// The excess of the radiosity of the lit part of a patch that reaches into a solid over its mean: B_i d_i / (1 - d_i),
/// where d_i is the dark share, at most 1/2. While the patch is wider than its dark part, the missing light does not
/// depend on the patch's size, so comparison with larger patches does not show it.
Field dark_differences(const LostShare& lost, const SolvedProblem& solved);

/// The error in gaps narrower than their patches. Comparison with larger patches does not show it: light from the rim
/// spreads over a whole patch. The error is (s - 0.35) / (1 - 0.35) min(H_i, D_i) / 2, or 0 where s < 0.35. s is the
/// share of the hemisphere with faces that look back from nearer than 0.6 edges; one face at that distance has 0.35.
/// D_i is the range of radiosities that the patch sees plus its direct light: irradiance by sources of equal radiosity
/// has no such error. The factor 1/2 is measured. `S` in m^2. O(size^2).
Field gap_errors(const PatchMesh& mesh, const ExchangeAreas& S, const SolvedProblem& solved);

/// The same by rows of rays, after `cuts` cuts of each patch. O(rays).
Field gap_errors(const PatchMesh& mesh, const RayTransport& transport, const SolvedProblem& solved, int cuts = 0);

/// The difference between points of a patch and its mean, from the differences between the patches of a parent. These
/// are sqrt(3) times those inside a patch if the irradiance is linear.
Field display_errors(const NestedMesh& mesh, const SolvedProblem& solved);

/// The solver's bound |dB_i| / rho_i. Patches without reflection get the largest of the others. Infinite if unknown.
Field solver_errors(const SolvedProblem& solved);

/// The problem for the parents of a mesh.
RadiosityProblem problem_of_parents(const NestedMesh& mesh, const RadiosityProblem& problem);

/// The counterpart of mesh_errors() for rows of rays: F (B_h - B_2h), where B_2h = E + R P F B_2h is the solution on
/// the parents and P the mean over each. B_h - B_2h = (1 - P) B + R e, where the mean irradiance of parents has the
/// error e = P F (1 - P) B + P F R e. The differences within a parent are known to the patches, so they cause an error
/// only where their light reaches other parents.
///
/// The error of the irradiance of each patch, W/m^2, is therefore F (1 - P) B + F R e by Richardson extrapolation. Two
/// halves of the rays give F (1 - P) B twice: the product has little bias by noise, and its mean over nearby patches
/// has less noise. As in mesh_errors() the larger of both is returned. Zero where no parent is cut.
Field errors_within_parents(const NestedMesh& mesh, const RayTransport& transport, const SolvedProblem& solved);

}  // namespace patchlight
