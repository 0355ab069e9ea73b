#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/plan/plan.h"
#include "patchlight/simulate.h"

#include <optional>
#include <vector>

namespace patchlight {

/// A mesh of which no edge is longer.
struct SizedMesh {
  double max_edge = 0;  ///< metres
  PatchMesh mesh;
};

/// Meshes each of which is cut from the one before, so that means over the patches of all can be taken from the last
/// without an error of their own: where a reference's patches reach over the edge of another patch, it would be off by
/// as much as they are large. Longest edges are halved each time, so that there are about four times the patches; what
/// would have more than half the patches of the next one is left out.
struct NestedSizes {
  std::vector<SizedMesh> sizes;  ///< from coarse to fine; the last one is about what the request asks for
  SizedMesh finer;               ///< with half the edges
  double coarsest_edge = 0;      ///< with which the scene is tessellated; metres
};

/// `sizes` sizes at most. \throws MemoryError when the finer mesh would not fit.
NestedSizes nested_sizes(const Scene& scene, const Request& request, int sizes);

/// The mesh, cut until a patch has no more than a quarter of the area of the one of `other` at its centre. Both are cut
/// from one tessellation: so each patch lies in one of `other`.
PatchMesh finer_than(PatchMesh mesh, const PatchMesh& other);

/// What the errors of a solution are measured against.
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

}  // namespace patchlight
