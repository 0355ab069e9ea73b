#include "patchlight/solve/spectral_radius.h"

namespace patchlight {

Eigen::ArrayXd spectral_radius(const TransportOperator& transport, const RadiosityProblem& problem, int steps) {
  // With B = rho o h, h an irradiance: h <- F (rho o h), radius = <rho h, F (rho h)> / <rho h, h>, weighted by area.
  const Field& rho = problem.reflectance;
  const auto dot = [&](const Field& x, const Field& y) -> Eigen::ArrayXd {
    return ((x * y).colwise() * problem.area.array()).colwise().sum().transpose();
  };
  Field h = Field::Ones(rho.rows(), rho.cols());
  Eigen::ArrayXd radius = Eigen::ArrayXd::Zero(rho.cols());
  for (int k = 0; k < steps; ++k) {
    const Field B = rho * h;
    const Field next = transport.apply(B);
    const Eigen::ArrayXd size = dot(B, h);
    radius = (size > 0).select(dot(B, next) / size, 0.0);
    const Eigen::ArrayXd length = dot(next, next).sqrt();
    h = next.rowwise() * (length > 0).select(1 / length, 0.0).transpose();
  }
  return radius;
}

}  // namespace patchlight
