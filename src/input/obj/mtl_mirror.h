#pragma once

#include "patchlight/light/spectrum.h"

#include <optional>
#include <string>

namespace patchlight {

/// What a material of an MTL file states of how it reflects light.
struct MtlReflection {
  Spectrum diffuse;                  ///< Kd
  std::optional<Spectrum> specular;  ///< Ks
  std::optional<double> exponent;    ///< Ns
  double roughness = 0;              ///< Pr
  double metallic = 0;               ///< Pm
  bool has_textures = false;         ///< of Ks, Ns, Pr or Pm
  int illumination = 0;              ///< illum
};

/// The mirror that it makes of the material.
struct MtlMirror {
  Spectrum specular_reflectance;
  Spectrum reflectance;   ///< what it reflects diffusely
  std::string statement;  ///< "illum 3"
};

/// The mirror that a material is; nothing where it is matt or glossy. An illumination with reflection makes one of what
/// has a Ks and is smooth. A metal reflects Kd, and nothing diffusely.
std::optional<MtlMirror> mtl_mirror(const MtlReflection& stated);

}  // namespace patchlight
