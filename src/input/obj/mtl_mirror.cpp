#include "input/obj/mtl_mirror.h"

#include "base/rounded.h"
#include "input/stated_mirrors.h"

namespace patchlight {
namespace {

// Reflection without refraction, with ray tracing or without.
bool is_of_mirror(int illumination) { return illumination == 3 || illumination == 5 || illumination == 8; }

// Blender writes Ns 1000 for a roughness of 0, and 250 for its usual one of 0.5.
bool is_smooth(const MtlReflection& stated) {
  constexpr double least_exponent = 900;
  return stated.exponent.value_or(least_exponent) >= least_exponent && stated.roughness <= most_roughness &&
         !stated.has_textures;
}

}  // namespace

std::optional<MtlMirror> mtl_mirror(const MtlReflection& stated) {
  if (!is_of_mirror(stated.illumination) || !is_smooth(stated) || !stated.specular) return std::nullopt;
  if (!(*stated.specular > 0).any()) return std::nullopt;
  const std::string statement = "illum " + std::to_string(stated.illumination);
  if (stated.metallic >= least_metallic) {
    if (!(stated.diffuse > 0).any()) return std::nullopt;
    return MtlMirror{stated.diffuse, Spectrum::Zero(3), statement + " and Pm " + rounded(stated.metallic)};
  }
  // Where the diffuse part takes all, none is left.
  if (!(stated.specular->min(1 - stated.diffuse) > 0).any()) return std::nullopt;
  return MtlMirror{*stated.specular, stated.diffuse, statement};
}

}  // namespace patchlight
