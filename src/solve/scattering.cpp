#include "solve/scattering.h"

#include "base/vectors.h"

namespace patchlight {

Field Scattering::reflect(const Field& irradiance) const { return reflectance * irradiance; }

Field Scattering::adjoint(const Field& radiosity) const { return reflectance * radiosity; }

Eigen::ArrayXd Scattering::norm_bound() const { return highest(reflectance); }

Field radiosity_from(const RadiosityProblem& problem, const Field& irradiance) {
  return problem.exitance + problem.scattering.reflectance * irradiance;
}

Field source_radiosity(const RadiosityProblem& problem) {
  if (problem.direct_irradiance.size() == 0) return problem.exitance;
  return radiosity_from(problem, problem.direct_irradiance);
}

Field reflect_even(const Scattering& scattering, const Eigen::ArrayXd& irradiance) {
  return scaled(scattering.reflectance, irradiance);
}

Field plus_reflected(Field radiosity, const Scattering& scattering, const Field& irradiance) {
  radiosity += scattering.reflectance * irradiance;
  return radiosity;
}

Field absorb(const Scattering& scattering, const Field& irradiance) {
  return (1 - scattering.reflectance) * irradiance;
}

Field irradiance_behind(const Scattering& scattering, const Field& reflected, const Field& otherwise) {
  const Field& rho = scattering.reflectance;
  return (rho > 0).select(reflected / rho, otherwise);
}

Field irradiance_errors(const Scattering& scattering, const Field& error) {
  const Field of_reflecting = irradiance_behind(scattering, error, Field::Zero(error.rows(), error.cols()));
  const Field largest_of_all = highest(of_reflecting).transpose().replicate(error.rows(), 1);
  return irradiance_behind(scattering, error, largest_of_all);
}

Field reflected_variance(const Scattering& scattering, const Field& variance) {
  return scattering.reflectance.square() * variance;
}

Eigen::ArrayXd reflected_square(const Scattering& scattering, const Field& irradiance, const Eigen::VectorXd& area) {
  return area_sum(scattering.reflectance * irradiance.square(), area);
}

Scattering of_bands(const Scattering& scattering, const std::vector<Eigen::Index>& bands) {
  Scattering some{Field(scattering.reflectance.rows(), static_cast<Eigen::Index>(bands.size()))};
  for (std::size_t k = 0; k < bands.size(); ++k)
    some.reflectance.col(static_cast<Eigen::Index>(k)) = scattering.reflectance.col(bands[k]);
  return some;
}

bool same_in_bands(const Scattering& scattering, Eigen::Index a, Eigen::Index b) {
  return (scattering.reflectance.col(a) == scattering.reflectance.col(b)).all();
}

SymmetricRoot::SymmetricRoot(const Scattering& scattering, const Eigen::VectorXd& area)
    : radiosity_(scattering.reflectance.sqrt().colwise() / area.array().sqrt()),
      from_irradiance_(scattering.reflectance.sqrt().colwise() * area.array().sqrt()) {}

}  // namespace patchlight
