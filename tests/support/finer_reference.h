#pragma once

#include "patchlight/simulate.h"

#include "support/sloped_field.h"

#include <algorithm>
#include <cmath>
#include <vector>

// Errors against a finer solution.
namespace patchlight::test {

/// Irradiance of a finer solution, and the exposed fraction of its patches.
struct FinerReference {
  PatchMesh mesh;
  SlopedField irradiance_times_share;
  SlopedField share;
};

inline FinerReference reference_of(const Simulation& finer) {
  const Eigen::Map<const Eigen::ArrayXd> area(finer.mesh.area.data(), finer.mesh.size());
  const Field share = finer.problem.area.array() / area;
  return {finer.mesh, with_slopes(finer.mesh, finer.solution.irradiance.colwise() * share.col(0)),
          with_slopes(finer.mesh, share)};
}

/// The deviation of the patches' mean irradiances from a reference.
struct TrueError {
  Field of_patches;     ///< W/m^2; 0 for patches that are almost fully covered
  double relative = 0;  ///< ||rho o error||_A / ||B - E||_A, worst band
};

inline TrueError error_against(const FinerReference& reference, const Simulation& simulation) {
  constexpr double hardly = 0.05;
  const RadiosityProblem& problem = simulation.problem;
  const Eigen::Map<const Eigen::ArrayXd> area(simulation.mesh.area.data(), simulation.mesh.size());
  const Field share = average_over(simulation.mesh, reference.mesh, reference.share);
  const Field mean = average_over(simulation.mesh, reference.mesh, reference.irradiance_times_share);
  TrueError error{(simulation.solution.irradiance - mean.colwise() / share.col(0).max(hardly)).abs(), 0};
  for (Eigen::Index i = 0; i < share.rows(); ++i) {
    if (share(i, 0) < hardly || problem.area[i] < hardly * area[i]) error.of_patches.row(i).setZero();
  }
  const Eigen::ArrayXd reflected = area_norm(simulation.solution.radiosity - problem.exitance, problem.area);
  error.relative = (area_norm(problem.scattering.reflectance * error.of_patches, problem.area) / reflected).maxCoeff();
  return error;
}

inline double median(const Field& values) {
  std::vector<double> sorted(values.data(), values.data() + values.size());
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  return sorted[sorted.size() / 2];
}

/// The fraction of patches and bands whose true error is not above the bar.
inline double covered(const Field& error, const Field& bar) {
  return static_cast<double>((error <= bar).count()) / static_cast<double>(error.size());
}

}  // namespace patchlight::test
