#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace patchlight {

/// Effects of light. docs/concepts/effects.md describes each.
enum class Effect : std::uint8_t {
  occlusion,        ///< polygons that stand between two patches
  interreflection,  ///< light that is reflected more than once before it is seen
  colour,           ///< bands that differ
  reach,            ///< rooms that light cannot enter
  backs,            ///< sides that look into the dark
  luminaires,       ///< lamps other than polygons
  sun,
  sky,
  textures,        ///< textures of surfaces: a reflectance for each patch, else one mean for each texture
  mirrors,         ///< specular reflection by mirrors and clear faces
  closure,         ///< correction of form factors, so that each row sums to the visible share
  bands_of_panes,  ///< the color of light between patches that passes clear faces and mirrors
  spectra,         ///< bands of wavelengths instead of linear RGB; decided when the scene is read
  gloss,           ///< of materials that are partly mirrors in the file; not simulated
  glass            ///< of materials that are transparent in the file; not simulated
};

/// The effects that a user may force or skip, in this order: all but the last four.
std::vector<Effect> simulated_effects();

/// The effect's name as on the command line.
const char* name_of(Effect effect);

/// True when the effect is one of the list.
bool contains(const std::vector<Effect>& effects, Effect effect);

/// Effects for which the user decides.
struct EffectOptions {
  std::vector<Effect> force = {};  ///< effects that are simulated whatever the scene is like
  std::vector<Effect> skip = {};   ///< effects that are left out; disjoint from `force`
};

/// Whether an effect is simulated, and why.
struct Decision {
  Effect effect = Effect::occlusion;
  bool simulate = true;
  std::string reason = {};  ///< the fact that decides
  std::string saving = {};  ///< the cost of simulating it or the saving of leaving it out, in words
  bool forced = false;      ///< the request overrules the fact
};

/// "occlusion: skipped by force; 6 of 12 faces can stand between two patches".
std::string sentence(const Decision& decision);

}  // namespace patchlight
