#pragma once

#include "patchlight/solve/solve.h"

namespace patchlight {

/// Jacobi iteration B <- E + rho o F B: iteration k adds bounce k (the Neumann series).
Solution jacobi(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options,
                const Observer& observer);

/// Gauss-Seidel: every patch gathers with the newest values of the patches before it.
Solution gauss_seidel(const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions& options,
                      const Observer& observer);

}  // namespace patchlight
