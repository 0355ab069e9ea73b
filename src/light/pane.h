#pragma once

namespace patchlight {

/// A thin plane-parallel pane with air on both sides, smooth and clear, for unpolarized light of one band. Fresnel's
/// equations for both of its surfaces, all reflections between them, and absorption on the way give its transmittance
/// and reflectance at an angle. The same from either side.
struct Pane {
  double index = 1;     ///< of refraction, at least 1; that of air, 1: a sheet with holes, the same at all angles
  double internal = 1;  ///< the share of light that is left after the way across, straight; 1: it absorbs nothing
};

/// The pane of an index of refraction, at least 1, that lets the share `transmittance`, in [0, 1], through at normal
/// incidence. Where a pane of that index lets less through although it absorbs nothing, as its surfaces reflect, the
/// index is lower, such that it absorbs nothing: 1 is no pane at all.
Pane pane_of(double index, double transmittance);

/// The share that goes straight through at an angle of incidence with this cosine, in [0, 1].
double transmittance(const Pane& pane, double cosine);

/// The share that is reflected as by a mirror. With the transmittance 1, less the absorbed share.
double specular_reflectance(const Pane& pane, double cosine);

}  // namespace patchlight
