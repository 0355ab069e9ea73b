#pragma once

#include "solve/iterations.h"

namespace patchlight {

/// Jacobi iteration B <- E + K B: iteration k adds bounce k (the Neumann series).
Solution jacobi(Iterations iterations);

/// Gauss-Seidel: every patch gathers with the newest values of the patches before it. The residual of an iterate is had
/// from the sums of the next sweep, which costs no further application.
Solution gauss_seidel(Iterations iterations, const RowTransport& transport);

/// Successive over-relaxation: Gauss-Seidel with its changes multiplied by options.relaxation, or by
/// relaxation_for(spectral_radius()) of the worst band.
Solution sor(Iterations iterations, const RowTransport& transport);

/// Gauss-Seidel from the first patch to the last and back.
Solution symmetric_gauss_seidel(Iterations iterations, const RowTransport& transport);

/// Chebyshev's semi-iteration for eigenvalues of K between -kappa and kappa, kappa the bound of
/// docs/theory/solvers-and-bounds.md below 1, else the spectral radius.
Solution chebyshev(Iterations iterations);

/// A relaxation factor for matrices whose spectrum is one mode with the eigenvalue `radius` < 1 far above all others:
/// where the mode and the rest decay alike. docs/theory/solvers-and-bounds.md.
double relaxation_for(double radius);

}  // namespace patchlight
