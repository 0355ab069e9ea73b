#pragma once

namespace patchlight {

/// A thin plane-parallel pane with air on both sides, smooth and clear, for unpolarized light of one band. Its
/// transmittance and reflectance at an angle follow from Fresnel's equations for both surfaces, all internal
/// reflections, and absorption. Both sides are equal.
struct Pane {
  double index = 1;     ///< of refraction, at least 1; that of air, 1: a sheet with holes, the same at all angles
  double internal = 1;  ///< internal transmittance at normal incidence; 1: no absorption
};

/// The pane of an index of refraction, at least 1, with the transmittance `transmittance`, in [0, 1], at normal
/// incidence. If reflection at this index leaves less than that even without absorption, the index is reduced and
/// nothing is absorbed. An index of 1 is no pane at all.
Pane pane_of(double index, double transmittance);

/// The transmittance at an angle of incidence with this cosine, in [0, 1].
double transmittance(const Pane& pane, double cosine);

/// The specular reflectance. Its sum with the transmittance is 1 minus the absorbed fraction.
double specular_reflectance(const Pane& pane, double cosine);

}  // namespace patchlight
