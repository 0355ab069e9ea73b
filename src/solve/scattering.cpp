#include "solve/scattering.h"

#include "base/vectors.h"

#include <cassert>
#include <limits>
#include <optional>

namespace patchlight {
namespace {

// The values of the patches on the other sides of sheets; nothing where there are none.
Field on_other_side(const Scattering& scattering, const Field& values) {
  Field others(values.rows(), values.cols());
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    others.row(i) = values.row(scattering.other_side[static_cast<std::size_t>(i)]);
  return others;
}

// The share of light that is scattered, to either side.
Field scattered_share(const Scattering& scattering) {
  if (scattering.is_diagonal()) return scattering.reflectance;
  return scattering.reflectance + scattering.transmittance;
}

// These columns; nothing of nothing.
Field columns_of(const FieldView& field, const std::vector<Eigen::Index>& columns) {
  if (field.size() == 0) return field;
  return field(Eigen::all, columns);
}

// The factor by which the lamps of band b are brighter than those of band a; nothing when there is no such factor.
std::optional<double> factor_of(const RadiosityProblem& problem, Eigen::Index a, Eigen::Index b) {
  if (!same_in_bands(problem.scattering, a, b)) return std::nullopt;
  Eigen::Index brightest = 0;
  const double of_a = problem.exitance.col(a).maxCoeff(&brightest);
  const double factor = problem.exitance(brightest, b) / of_a;
  const auto expected = factor * problem.exitance.col(a);
  // Sixteen roundings: of sums and products of E, rho and H_direct, and of a quotient.
  const auto rounding = 16 * std::numeric_limits<double>::epsilon() * expected;
  const bool is_multiple = ((expected - problem.exitance.col(b)).abs() <= rounding).all();
  return is_multiple ? std::optional(factor) : std::nullopt;
}

}  // namespace

Field Scattering::reflect(const Field& irradiance) const {
  if (is_diagonal()) return reflectance * irradiance;
  return reflectance * irradiance + transmittance * on_other_side(*this, irradiance);
}

Field Scattering::adjoint(const Field& radiosity) const { return reflect(radiosity); }

// R is similar to a symmetric matrix, the norm of which is its spectral radius: no row sum of R is below it.
Eigen::ArrayXd Scattering::norm_bound() const { return highest(scattered_share(*this)); }

Field radiosity_from(const RadiosityProblem& problem, const Field& irradiance) {
  return plus_reflected(problem.exitance, problem.scattering, irradiance);
}

Field source_radiosity(const RadiosityProblem& problem) {
  if (problem.direct_irradiance.size() == 0) return problem.exitance;
  return radiosity_from(problem, problem.direct_irradiance);
}

Solution reflected_once(const RadiosityProblem& problem, Field irradiance) {
  Solution solution;
  solution.radiosity = radiosity_from(problem, irradiance);
  solution.error = Field::Zero(irradiance.rows(), irradiance.cols());
  solution.direct_irradiance = irradiance;
  solution.irradiance = std::move(irradiance);
  solution.patch_bound = 0;
  solution.converged = true;
  return solution;
}

Field reflect_even(const Scattering& scattering, const Eigen::ArrayXd& irradiance) {
  return scaled(scattered_share(scattering), irradiance);
}

Field plus_reflected(Field radiosity, const Scattering& scattering, const Field& irradiance) {
  radiosity += scattering.reflectance * irradiance;
  if (!scattering.is_diagonal()) radiosity += scattering.transmittance * on_other_side(scattering, irradiance);
  return radiosity;
}

Field absorb(const Scattering& scattering, const Field& irradiance) {
  return (1 - scattered_share(scattering)) * irradiance;
}

Field irradiance_behind(const Scattering& scattering, const Field& reflected, const Field& otherwise) {
  const Field& rho = scattering.reflectance;
  if (scattering.is_diagonal()) return (rho > 0).select(reflected / rho, otherwise);
  return (rho > 0 && scattering.transmittance == 0).select(reflected / rho, otherwise);
}

Field irradiance_errors(const Scattering& scattering, const Field& error) {
  const Field& rho = scattering.reflectance;
  const Field unknown = Field::Constant(error.rows(), error.cols(), std::numeric_limits<double>::infinity());
  Field bound = (rho > 0).select(error / rho, unknown);
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> is_known = rho > 0;
  if (!scattering.is_diagonal()) {
    // |dB_i| = rho_i |dH_i| + t_i |dH_j| bounds |dH_i| by |dB_i| / rho_i, and that of the other side by |dB_j| / t_j.
    const Field t = on_other_side(scattering, scattering.transmittance);
    bound = bound.min((t > 0).select(on_other_side(scattering, error) / t, unknown)).eval();
    is_known = is_known || t > 0;
  }
  const Field largest_of_all = highest(is_known.select(bound, 0.0)).transpose().replicate(error.rows(), 1);
  return is_known.select(bound, largest_of_all);
}

Field reflected_error(const Scattering& scattering, const Field& error) {
  const Field& rho = scattering.reflectance;
  Field reflected = (rho > 0).select(rho * error, 0.0);
  if (scattering.is_diagonal()) return reflected;
  const Field& t = scattering.transmittance;
  reflected += (t > 0).select(t * on_other_side(scattering, error), 0.0);
  return reflected;
}

Field reflected_variance(const Scattering& scattering, const Field& variance) {
  Field reflected = scattering.reflectance.square() * variance;
  if (!scattering.is_diagonal()) reflected += scattering.transmittance.square() * on_other_side(scattering, variance);
  return reflected;
}

Eigen::ArrayXd reflected_square(const Scattering& scattering, const Field& irradiance, const Eigen::VectorXd& area) {
  if (scattering.is_diagonal()) return area_sum(scattering.reflectance * irradiance.square(), area);
  return area_sum(irradiance * scattering.reflect(irradiance), area);
}

Scattering of_bands(const Scattering& scattering, const std::vector<Eigen::Index>& bands) {
  return {columns_of(scattering.reflectance, bands), scattering.other_side,
          columns_of(scattering.transmittance, bands)};
}

bool same_in_bands(const Scattering& scattering, Eigen::Index a, Eigen::Index b) {
  const auto is_same = [a, b](const Field& field) { return (field.col(a) == field.col(b)).all(); };
  return is_same(scattering.reflectance) && (scattering.is_diagonal() || is_same(scattering.transmittance));
}

SymmetricRoot::SymmetricRoot(const Scattering& scattering, const Eigen::VectorXd& area)
    : radiosity_(scattering.reflectance.sqrt().colwise() / area.array().sqrt()),
      from_irradiance_(scattering.reflectance.sqrt().colwise() * area.array().sqrt()) {
  assert(scattering.is_diagonal());
}

SolvedBands solved_bands(const RadiosityProblem& problem) {
  SolvedBands bands;
  for (Eigen::Index band = 0; band < problem.exitance.cols(); ++band) {
    if ((problem.exitance.col(band) == 0).all()) {
      bands.sources.push_back({0, 0});
      continue;
    }
    std::optional<double> factor;
    Eigen::Index from = 0;
    const auto solved = static_cast<Eigen::Index>(bands.solved.size());
    while (from < solved && !(factor = factor_of(problem, bands.solved[static_cast<std::size_t>(from)], band))) ++from;
    if (!factor) bands.solved.push_back(band);
    bands.sources.push_back({from, factor.value_or(1)});
  }
  if (bands.solved.empty()) bands.solved.push_back(0);
  return bands;
}

SolvedBands all_bands(const RadiosityProblem& problem) {
  SolvedBands bands;
  for (Eigen::Index band = 0; band < problem.exitance.cols(); ++band) {
    bands.solved.push_back(band);
    bands.sources.push_back({band, 1});
  }
  return bands;
}

Field reduced(const FieldView& field, const SolvedBands& bands) { return columns_of(field, bands.solved); }

Field expanded(const FieldView& field, const SolvedBands& bands) {
  if (field.size() == 0) return field;
  Field all(field.rows(), static_cast<Eigen::Index>(bands.sources.size()));
  for (Eigen::Index band = 0; band < all.cols(); ++band) {
    const SolvedBands::Source& source = bands.sources[static_cast<std::size_t>(band)];
    all.col(band) = source.factor * field.col(source.from);
  }
  return all;
}

Observer telling_all_bands(const Observer& observer, const SolvedBands& bands, const Field* more_irradiance) {
  if (!observer) return {};
  return [&observer, &bands, more_irradiance](const Progress& progress) {
    if (!progress.irradiance) return observer(progress);
    Progress all = progress;
    const Field ambient = progress.ambient != nullptr ? expanded(*progress.ambient, bands) : Field();
    all.irradiance = [&] {
      Field irradiance = expanded(progress.irradiance(), bands);
      if (more_irradiance != nullptr && more_irradiance->size() > 0) irradiance += *more_irradiance;
      return irradiance;
    };
    all.ambient = progress.ambient != nullptr ? &ambient : nullptr;
    return observer(all);
  };
}

}  // namespace patchlight
