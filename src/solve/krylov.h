#pragma once

#include "solve/iterations.h"

namespace patchlight {

// Krylov methods, all bands at once with scalars of their own. Every direction goes with its F times it, so that the
// irradiance of the iterates, and with it their residual, is had without further applications, also at patches that
// reflect nothing. Written here because library routines take one band at a time and hide their iterates.

/// Conjugate gradients (Hestenes and Stiefel 1952) on the symmetric system (I - G) w = R^1/2 A^-1/2 S E with
/// B = E + R^1/2 A^-1/2 w and G = R^1/2 A^-1/2 S A^-1/2 R^1/2. docs/theory/solvers-and-bounds.md.
Solution cg(Iterations iterations);

/// The same with the mode deflated that is constant irradiance (Saad, Yeung, Erhel and Guyomarc'h 2000, algorithm 3.6):
/// one application more, and the largest eigenvalue no longer counts.
Solution deflated_cg(Iterations iterations);

/// GMRES with options.restart directions (Saad and Schultz 1986), minimising ||r||_A.
Solution gmres(Iterations iterations);

/// BiCGSTAB (van der Vorst 1992); two applications an iteration.
Solution bicgstab(Iterations iterations);

/// A loose solution for a problem of which all patches emit 1: by conjugate gradients until no residual is above 1/2.
struct GlowingRadiosity {
  Field radiosity;
  int applications = 0;
};
GlowingRadiosity glowing_radiosity(const TransportOperator& transport, const RadiosityProblem& problem,
                                   int max_iterations);

}  // namespace patchlight
