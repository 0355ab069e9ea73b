#pragma once

#include "patchlight/base/field.h"

namespace patchlight {

/// Error bars of the irradiances of a solution, by source of error: per patch and band, W/m^2. Mesh and form-factor
/// errors are estimates of one standard deviation of the patch's mean; the solver error is a bound. Radiosities have
/// the reflectance times these errors.
struct ErrorBars {
  Field mesh;         ///< from the size of all patches
  Field mesh_noise;   ///< its square is the part of the square of `mesh` due to noise. The difference of both squares,
                      ///< summed over many patches, has hardly any bias. Empty if unknown
  Field form_factor;  ///< from the sampling of form factors
  Field solver;
  Field display;  ///< root mean square difference between the irradiance at a point and the patch's mean

  /// sqrt(mesh^2 + form_factor^2 + solver^2)
  Field total() const;
};

}  // namespace patchlight
