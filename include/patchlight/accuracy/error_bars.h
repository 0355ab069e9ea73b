#pragma once

#include "patchlight/base/field.h"

namespace patchlight {

/// How far the irradiances of a solution may be off, by where it comes from: per patch and band, W/m^2. Those of mesh
/// and form factors are estimates of one standard deviation of the patch's mean, that of the solver is a bound.
/// Radiosities are off by the reflectance times as much.
struct ErrorBars {
  Field mesh;        ///< from the size of all patches
  Field mesh_noise;  ///< its square is what noise adds to that of `mesh`: the sum of both squares' difference over many
                     ///< patches has hardly any bias; empty where nothing is known of it
  Field form_factor;  ///< from the sampling of form factors
  Field solver;
  Field display;  ///< how far the irradiance at a point of a patch is from the patch's mean, root mean square

  /// sqrt(mesh^2 + form_factor^2 + solver^2)
  Field total() const;
};

}  // namespace patchlight
