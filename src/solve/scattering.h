#pragma once

#include "patchlight/solve/problem.h"

#include <Eigen/Core>
#include <vector>

namespace patchlight {

/// (R H)_i of a diagonal R, one row, from `irradiance`, the row H_i: an expression that refers to both, for use at
/// once.
inline auto reflect_at(const Scattering& scattering, Eigen::Index patch, const Field& irradiance) {
  return scattering.reflectance.row(patch) * irradiance;
}

/// The solution for light that is reflected once: B = E + R H, exact for a given H of all light.
Solution reflected_once(const RadiosityProblem& problem, Field irradiance);

/// R H of an irradiance that is the same everywhere, one value per band.
Field reflect_even(const Scattering& scattering, const Eigen::ArrayXd& irradiance);

/// radiosity + R H
Field plus_reflected(Field radiosity, const Scattering& scattering, const Field& irradiance);

/// (1 - R) H: the absorbed irradiance, W/m^2.
Field absorb(const Scattering& scattering, const Field& irradiance);

/// The irradiance H for which R H is `reflected`; that of `otherwise` where nothing is reflected, and on sheets.
Field irradiance_behind(const Scattering& scattering, const Field& reflected, const Field& otherwise);

/// How far irradiances may be off when radiosities are by `error`, |dB| = R |dH|, W/m^2; for patches that reflect
/// nothing the largest of the others. On sheets the smaller bound of both sides.
Field irradiance_errors(const Scattering& scattering, const Field& error);

/// R times an error of the irradiance, which may be infinite where it is not known: 0 of what reflects nothing.
Field reflected_error(const Scattering& scattering, const Field& error);

/// The variances of R H, from those of irradiances that do not depend on each other.
Field reflected_variance(const Scattering& scattering, const Field& variance);

/// sum_i A_i H_i (R H)_i per band: the square of the norm in which K and its symmetric form have one spectrum.
Eigen::ArrayXd reflected_square(const Scattering& scattering, const Field& irradiance, const Eigen::VectorXd& area);

/// R of these bands, in this order; a band may come several times.
Scattering of_bands(const Scattering& scattering, const std::vector<Eigen::Index>& bands);

/// True when R is the same in both bands.
bool same_in_bands(const Scattering& scattering, Eigen::Index a, Eigen::Index b);

/// The square root of a diagonal R, R = R^1/2 R^1/2, with the areas that make the system symmetric.
/// Let B = E + D w, D = R^1/2 A^-1/2 and T = R^1/2 A^1/2. Then B = E + R F B becomes (I - T F D) w = T F E. T F D is
/// symmetric.
class SymmetricRoot {
 public:
  SymmetricRoot(const Scattering& scattering, const Eigen::VectorXd& area);

  /// D w, radiosity in W/m^2.
  Field radiosity_of(const Field& w) const { return radiosity_ * w; }
  /// T H, in the units of w.
  Field of_irradiance(const Field& irradiance) const { return from_irradiance_ * irradiance; }
  /// T 1, what irradiance 1 everywhere comes to.
  const Field& of_even_irradiance() const { return from_irradiance_; }

 private:
  Field radiosity_;        // D
  Field from_irradiance_;  // T
};

/// Which bands have to be solved: those without light have the solution 0, and of those with the same reflectances
/// whose lamps differ by a factor one is enough.
struct SolvedBands {
  /// Where a band of the problem comes from: `factor` times the solved band `from`.
  struct Source {
    Eigen::Index from = 0;
    double factor = 0;
  };
  std::vector<Eigen::Index> solved;  ///< bands of the problem; at least one
  std::vector<Source> sources;       ///< one for each band of the problem
};

SolvedBands solved_bands(const RadiosityProblem& problem);

/// Each band as it is.
SolvedBands all_bands(const RadiosityProblem& problem);

/// The columns of the solved bands; nothing of nothing.
Field reduced(const FieldView& field, const SolvedBands& bands);

/// All bands from the solved ones.
Field expanded(const FieldView& field, const SolvedBands& bands);

/// An observer of the solved bands that calls the one of all bands. `more_irradiance`, of all bands and in none of the
/// solved ones, is added where it is given and not empty. Refers to all arguments.
Observer telling_all_bands(const Observer& observer, const SolvedBands& bands, const Field* more_irradiance = nullptr);

}  // namespace patchlight
