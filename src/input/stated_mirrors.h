#pragma once

#include "patchlight/scene/scene.h"

#include <string>

namespace patchlight {

/// The roughness, of glTF and of MTL files with PBR, up to which a surface is taken for smooth.
inline constexpr double most_roughness = 0.05;

/// The metalness, of the same, from which it is taken for metal.
inline constexpr double least_metallic = 0.9;

/// The material as the mirror that a model file makes of it by this statement; what is left of its reflectance is
/// reflected diffusely besides. Of the shares that are reflected as by a mirror negative ones become 0.
Material as_mirror(Material material, const Spectrum& specular_reflectance, const Spectrum& left,
                   std::string statement);

/// The material without the mirror that a model file makes of it: matt.
Material without_stated_mirror(Material material);

/// The scene with all settings, of which the mirrors that files state reflect as mirrors no more than what they do not
/// reflect diffusely. One note names them and the setting that makes them matt, another one those that reflect less by
/// that.
Scene with_stated_mirrors(Scene scene);

}  // namespace patchlight
