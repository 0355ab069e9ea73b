#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/simulate.h"

#include <optional>

namespace patchlight {

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
