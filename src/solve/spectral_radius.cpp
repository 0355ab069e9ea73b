#include "solve/spectral_radius.h"

#include "base/vectors.h"
#include "solve/scattering.h"

namespace patchlight {

Eigen::ArrayXd spectral_radius(const TransportOperator& transport, const RadiosityProblem& problem, int steps) {
  // With B = rho o h, h an irradiance, w = (A rho)^1/2 h: h <- F (rho o h) is w <- G w, and radius = ||G w|| / ||w||.
  const auto squares = [&](const Field& h) { return reflected_square(problem.scattering, h, problem.area); };
  Field h = Field::Ones(problem.exitance.rows(), problem.exitance.cols());
  Eigen::ArrayXd radius = Eigen::ArrayXd::Zero(h.cols());
  for (int k = 0; k < steps; ++k) {
    const Field next = transport.apply(problem.scattering.reflect(h));
    const Eigen::ArrayXd before = squares(h);
    const Eigen::ArrayXd after = squares(next);
    radius = (before > 0).select((after / before).sqrt(), 0.0);
    const Eigen::ArrayXd scale = (after > 0).select(after.sqrt().inverse(), 0.0);
    h = scaled(next, scale);
  }
  return radius;
}

}  // namespace patchlight
