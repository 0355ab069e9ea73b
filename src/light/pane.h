#pragma once

#include "patchlight/light/spectrum.h"

#include <cstddef>
#include <vector>

namespace patchlight {

/// A thin plane-parallel pane with air on both sides, smooth and clear, for unpolarized light of one band. Its
/// transmittance and reflectance at an angle follow from Fresnel's equations for both surfaces, all internal
/// reflections, and absorption. Both sides are equal.
struct Pane {
  double index = 1;     ///< of refraction, at least 1; that of air, 1: a sheet with holes, the same at all angles
  double internal = 1;  ///< internal transmittance at normal incidence; 1: no absorption

  bool operator==(const Pane&) const = default;
};

/// The pane of an index of refraction, at least 1, with the transmittance `transmittance`, in [0, 1], at normal
/// incidence. If reflection at this index leaves less than that even without absorption, the index is reduced and
/// nothing is absorbed. An index of 1 is no pane at all.
Pane pane_of(double index, double transmittance);

/// Fractions of the light at one angle; a pane absorbs the rest.
struct PaneShares {
  double transmitted = 0;
  double reflected = 0;
};

/// Both at an angle of incidence with this cosine, in [0, 1], as the mean of both polarizations.
PaneShares shares(const Pane& pane, double cosine);

/// The transmittance at an angle of incidence with this cosine, in [0, 1].
double transmittance(const Pane& pane, double cosine);

/// The specular reflectance. Its sum with the transmittance is 1 minus the absorbed fraction.
double specular_reflectance(const Pane& pane, double cosine);

/// The panes of a clear material, one per band: its index of refraction and its transmittances at normal incidence.
std::vector<Pane> panes_of(double index, const Spectrum& transmittance);

/// The transmittance per band.
Spectrum transmittance(const std::vector<Pane>& panes, double cosine);

/// The specular reflectance per band.
Spectrum specular_reflectance(const std::vector<Pane>& panes, double cosine);

/// The fraction of light that is absorbed or scattered: 1 minus the specular fraction, at least 1e-6.
double nonspecular_rest(double specular);

/// Midpoint rule for the mean over the hemisphere, weighted by the cosine. This number of steps gives the fraction that
/// ordinary glass absorbs within 2e-6.
inline constexpr std::size_t cosine_steps = 1024;

/// The cosine at the middle of a step.
double cosine_of_step(std::size_t step);

/// The weight of a step. All weights add up to 1.
double irradiance_of_step(std::size_t step);

/// The mean over the hemisphere of the fraction that panes absorb or scatter, per band, weighted by the cosine.
/// Reflections count as absorbed unless they go on.
Spectrum hemispherical_nonspecular(const std::vector<Pane>& panes, bool reflections_go_on = false);

/// The same mean of the specular reflectance of one pane.
double hemispherical_reflectance(const Pane& pane);

}  // namespace patchlight
