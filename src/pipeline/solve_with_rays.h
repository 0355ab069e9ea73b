#pragma once

#include "patchlight/solve/solve.h"

#include "pipeline/exchange_and_light.h"
#include "solve/pockets.h"
#include "solve/scattering.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace patchlight {

/// The closed spaces of a mesh. The patches of a closed space exchange light with each other alone, directly or through
/// translucent sheets, and lose at most a fiftieth of it.
struct ClosedSpaces {
  static constexpr std::uint32_t open = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> space_of;  ///< per patch: its closed space, or `open`
  Eigen::Index count = 0;
};

/// Finds the connected components of the rows and of the sheets, and keeps those that lose at most a fiftieth of
/// their light. `row_sum` is the fraction s_j of the hemisphere of patch j that other patches fill. O(rays).
ClosedSpaces find_closed_spaces(const RayTransport& rays, const RadiosityProblem& problem,
                                const Eigen::VectorXd& row_sum);

/// The flux that sampling errors of the rows lose or add in each closed space. Each row sums to s_j, but the columns do
/// not: by reciprocity sum_i A_i (F B)_i = sum_j A_j s_j B_j within a space. The correction distributes the missing
/// flux of a space in proportion to the irradiance: H = F B + shape (sum_j A_j s_j B_j - sum_i A_i (F B)_i). Without it
/// a room of reflectance rho changes its level 1 / (1 - rho) times as much. An open space gets no correction: the
/// errors of its rows would be paid by others. In a room with a window those of the ground outside are larger than its
/// own.
struct ConservedFlux {
  ClosedSpaces spaces;
  Eigen::VectorXd seen_area;  ///< A_j s_j, m^2
  Field shape;                ///< of the missing flux, 1/m^2: sum_i A_i shape_i = 1 in each closed space; 0 elsewhere

  /// F B with the missing flux of each space; `gathered` is F B.
  Field completed(Field gathered, const Field& radiosity, const Eigen::VectorXd& area) const;
};

/// A solution and the flux that it conserves. `solution` has the corrected radiosity B, and the irradiance before.
struct ConservingSolution {
  Solution solution;
  ConservedFlux flux;
  std::array<Field, 2> gathered;  ///< F B by each half of the rays, W/m^2; F E where light is reflected once
};

/// Corrects a solution B = E + R (F B + H_direct) so that each closed space conserves flux, by the Sherman-Morrison
/// formula: a second solution, of `shape` reflected, is the response to a missing watt. The residual of the second
/// solution is added to the error of the first. `row_sum` is s_j. Returns the solution unchanged, with a `shape` of 0,
/// where there is no closed space or one of both solutions does not converge. \throws Canceled.
ConservingSolution conserving_flux(const RaysWithPockets& transport, const RadiosityProblem& problem, Solution solution,
                                   const Eigen::VectorXd& row_sum, const Observer& observer = {});

/// The problem for rows of rays in the needed bands. The light of each other band, and its errors, are a factor times
/// those of one needed band.
struct NeededLight {
  SolvedBands bands;
  RadiosityProblem problem;  ///< for the rows: exitance without the separate lamps, whose light is direct
  Field of_lamps;            ///< variance of the irradiance by separate lamps, (W/m^2)^2
  Field of_others;           ///< variance of that by luminaires, sun, sky and mirrors; empty where there is none
};

/// All bands if each has to be solved: with SolverOptions::every_band or with a reference.
NeededLight needed_light(const RayLight& light, const SolverOptions& options);

/// A solution by rows of rays, with the standard error of its irradiance and the correlated part of the error, W/m^2.
struct RaySolution {
  Solution solution;
  Field standard_error;
  std::vector<Field> correlated_errors;  ///< Simulation::correlated_errors
};

/// Solves B = E + rho o (F B + H_direct) with separate lamps and conserved flux (ConservedFlux). Gathers again by each
/// half of the rays, and smooths the light from other patches: docs/theory/ray-method-solution.md. The error combines
/// the difference of the halves, the error of the row sums that both halves share, the bias of smoothing, and the
/// reflections of these. \throws Canceled; InputError for solvers that do not support rows of rays.
RaySolution solve_with_rays(const Run& run, const PatchMesh& mesh, const RaysWithPockets& transport,
                            const RayLight& light, const TransportFacts& facts, const SolverOptions& options);

}  // namespace patchlight
