#include "study/verified_part.h"

#include "base/vectors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// Two sums of the same light may differ by so much of it for rounding alone.
constexpr double rounding = 1e-10;

// The noise is estimated from few batches, which gives Student's t. If none of n paths met light, the share that does
// is below 3 / n with 95 % confidence (Hanley and Lippman-Hand 1983): of the brightest light that was traced.
Field variance_of(const PathEstimate& paths) {
  constexpr double degrees = path_batches - 1;
  Field noise = paths.standard_error.square() * (degrees / (degrees - 2)) + (rounding * paths.irradiance).square();
  if (noise.rows() == 0) return noise;
  const Spectrum of_none = (3 * highest(paths.irradiance).transpose() / paths.paths).square();
  return (paths.irradiance == 0).select(of_none.replicate(noise.rows(), 1), noise);
}

Field rows_at(const Field& field, const std::vector<Eigen::Index>& rows) {
  Field chosen(static_cast<Eigen::Index>(rows.size()), field.cols());
  for (std::size_t k = 0; k < rows.size(); ++k) chosen.row(static_cast<Eigen::Index>(k)) = field.row(rows[k]);
  return chosen;
}

}  // namespace

Eigen::ArrayXd ratio(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) { return (a == 0).select(a, a / b); }

VerifiedPart verify_part(const std::string& name, const SolvedAndTraced& compared, std::vector<Eigen::Index> rows) {
  VerifiedPart part;
  part.name = name;
  part.rows = std::move(rows);
  const Field solved = rows_at(compared.irradiance, part.rows);
  const Field traced = rows_at(compared.paths.irradiance, part.rows);
  const Field bar = rows_at(compared.bar, part.rows);
  const Field variance = rows_at(variance_of(compared.paths), part.rows);
  part.dark = (solved == 0 && traced == 0).cast<double>().colwise().sum().transpose();
  part.chi_square = sum_over_patches(rows_at(deviations(compared), part.rows).square());

  // The common offset. Bars are correlated by an unknown amount: assume all of it.
  const Eigen::ArrayXd difference = sum_over_patches(solved - traced);
  part.mean_difference = ratio(difference, sum_over_patches(traced));
  part.offset = ratio(difference, (sum_over_patches(variance) + sum_over_patches(bar).square()).sqrt());

  // The typical error. The noise of the paths adds its squares to those of the differences.
  const Eigen::ArrayXd noise = sum_over_patches(rows_at(compared.paths.standard_error, part.rows).square());
  const Eigen::ArrayXd light = (sum_over_patches(traced.square()) - noise).max(0.0);
  part.error = ratio((sum_over_patches((solved - traced).square()) - noise).max(0.0), light).sqrt();
  part.noise = ratio(noise, light).sqrt();

  const Eigen::ArrayXd of_bars = ratio(sum_over_patches(bar.square()).sqrt(), sum_over_patches(traced.square()).sqrt());
  const Eigen::ArrayXd of_noise = ratio(sum_over_patches(variance).sqrt(), sum_over_patches(traced));
  part.width = largest(of_bars.max(of_noise));
  return part;
}

Field deviations(const SolvedAndTraced& compared) {
  const Field noise = variance_of(compared.paths);
  const Field difference = compared.irradiance - compared.paths.irradiance;
  const Field none = Field::Zero(difference.rows(), difference.cols());
  return (difference == 0).select(none, difference / (noise + compared.bar.square()).sqrt());
}

Field deviations_by_noise(const SolvedAndTraced& compared) {
  const Field& noise = compared.paths.standard_error;
  const Field unknown = Field::Constant(noise.rows(), noise.cols(), std::numeric_limits<double>::quiet_NaN());
  const Field rounded = (noise.square() + (rounding * compared.paths.irradiance).square()).sqrt();
  return (noise > 0).select((compared.irradiance - compared.paths.irradiance) / rounded, unknown);
}

}  // namespace patchlight
