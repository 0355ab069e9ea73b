#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/entry_errors.h"
#include "patchlight/transport/transport_operator.h"

#include <cstdint>

namespace patchlight {

/// How far the radiosities of a solution may be off, by where it comes from: per patch and band, W/m^2. Those of mesh
/// and form factors are estimates of one standard deviation, that of the solver is a bound.
struct ErrorBars {
  Field mesh;         ///< of the patch's mean radiosity, from the size of all patches
  Field form_factor;  ///< from the sampling of form factors
  Field solver;

  /// sqrt(mesh^2 + form_factor^2 + solver^2)
  Field total() const;
};

/// A bar as one figure: ||bar||_A / ||B - E||_A, the worst band.
double relative_error(const FieldView& bar, const RadiosityProblem& problem, const FieldView& radiosity);

/// What the sampling of form factors does to the radiosities: the root mean square over random draws of the entries'
/// errors (random_errors()), each followed through all reflections, e = R A^-1 D B + K e. In a closed scene the draws
/// are closed as the matrix was, so that rows keep their sums. docs/theory.md section 10. Costs some tens of
/// applications.
Field form_factor_errors(const RowTransport& transport, const RadiosityProblem& problem, const FieldView& radiosity,
                         const EntryErrors& errors, bool closed, std::uint64_t seed = 1);

/// The solution on a mesh.
struct SolvedMesh {
  const PatchMesh& mesh;
  const Field& radiosity;
  const Eigen::VectorXd& area;  ///< m^2, exposed
};

/// What the size of the patches does to their mean radiosities, by Richardson's extrapolation from the mesh of which
/// `fine` is the refinement: |B_h - B_2h| / (2^order - 1), with B_h averaged over each coarse patch. Of that and its
/// root mean square over the patches around, the larger: where the difference changes sign, it is not the error that is
/// 0.
Field mesh_errors(const PatchMesh& coarse, const Field& coarse_radiosity, const SolvedMesh& fine, double order = 1.5);

}  // namespace patchlight
