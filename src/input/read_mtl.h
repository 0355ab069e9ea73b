#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"

#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// A material of an MTL file.
struct MtlMaterial {
  std::string name;
  Spectrum reflectance;               ///< Kd
  Spectrum radiance;                  ///< Ke, W/(m^2 sr)
  Spectrum ambient;                   ///< Ka
  bool has_reflectance = false;       ///< Kd is given
  bool is_specular = false;           ///< Ks is not 0
  std::vector<std::string> textures;  ///< the files of map_, bump, disp, refl and norm
  bool is_transparent = false;        ///< d < 1 or Tr > 0
  bool is_mirror_or_glass = false;    ///< illum 3 to 9
  bool is_metallic = false;           ///< Pm is not 0
};

/// Reads the materials of an MTL file; of materials with the same name the first is kept.
/// \throws InputError naming `file` and the line when Kd or Ke is not three finite numbers.
std::vector<MtlMaterial> read_mtl(const std::string& text, const std::string& file);

/// One sentence per property that these materials have and the simulation ignores.
std::vector<std::string> notes_on_ignored(std::span<const MtlMaterial> materials);

/// The numbers of materials with properties that have a place in the plan.
std::vector<UnsimulatedMaterials> unsimulated(std::span<const MtlMaterial> materials);

}  // namespace patchlight
