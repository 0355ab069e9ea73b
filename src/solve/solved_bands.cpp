#include "solve/solved_bands.h"

#include "solve/scattering.h"

#include <limits>
#include <optional>

namespace patchlight {
namespace {

// The factor by which the lamps of band b are brighter than those of band a; nothing when there is no such factor.
std::optional<double> factor_of(const RadiosityProblem& problem, Eigen::Index a, Eigen::Index b) {
  if (!same_in_bands(problem.scattering, a, b)) return std::nullopt;
  Eigen::Index brightest = 0;
  const double of_a = problem.exitance.col(a).maxCoeff(&brightest);
  const double factor = problem.exitance(brightest, b) / of_a;
  // Rounding of sums and products of E, rho and H_direct, and of a quotient.
  constexpr double tolerance = 16 * std::numeric_limits<double>::epsilon();
  const auto expected = factor * problem.exitance.col(a);
  const bool is_multiple = ((expected - problem.exitance.col(b)).abs() <= tolerance * expected).all();
  return is_multiple ? std::optional(factor) : std::nullopt;
}

}  // namespace

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

Field reduced(const FieldView& field, const SolvedBands& bands) {
  if (field.size() == 0) return field;
  Field columns(field.rows(), static_cast<Eigen::Index>(bands.solved.size()));
  for (Eigen::Index k = 0; k < columns.cols(); ++k)
    columns.col(k) = field.col(bands.solved[static_cast<std::size_t>(k)]);
  return columns;
}

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
