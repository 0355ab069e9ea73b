#pragma once

#include "patchlight/light/spectrum.h"

#include <optional>
#include <string>

namespace patchlight {

/// What a material of an MTL file states of how it lets light through.
struct MtlTransparency {
  std::optional<double> dissolve;      ///< d: 1 is opaque
  std::optional<double> transparency;  ///< Tr: 0 is opaque
  std::optional<Spectrum> filter;      ///< Tf
  std::optional<double> index;         ///< Ni
  int illumination = 0;                ///< illum
};

/// The pane that it makes of the material.
struct MtlPane {
  Spectrum transmittance;
  double index = 0;                       ///< of refraction
  std::string statement;                  ///< "d 0.3"
  std::optional<Spectrum> reflectance{};  ///< where it has holes: what is left of the material's
};

/// The pane that a material is; nothing where it is opaque. d counts before Tr, and Tf colours what they let through.
/// Without both Tf alone counts with an illumination for glass, unless it is 1 in all bands, as programs write it for
/// what is opaque.
std::optional<MtlPane> mtl_pane(const MtlTransparency& stated);

/// True when d and Tr contradict each other about whether the material is opaque: some programs mean opacity by Tr.
bool is_contradictory(const MtlTransparency& stated);

}  // namespace patchlight
