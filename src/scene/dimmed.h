#pragma once

#include "patchlight/scene/luminaire.h"

#include <variant>

namespace patchlight {

/// A luminaire that gives a share of its light.
inline Luminaire dimmed(Luminaire luminaire, double share) {
  struct Dim {
    double share;
    void operator()(PointLight& light) const { light.intensity *= share; }
    void operator()(SpotLight& light) const { light.intensity *= share; }
    void operator()(WebLight& light) const { light.watts_per_lumen *= share; }
    void operator()(SphericalLamp& light) const { light.exitance *= share; }
  };
  std::visit(Dim{share}, luminaire.light);
  return luminaire;
}

}  // namespace patchlight
