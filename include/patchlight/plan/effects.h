#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace patchlight {

/// Effects that can be simulated or left out. docs/concepts/effects.md has a row on each.
enum class Effect : std::uint8_t {
  occlusion,        ///< polygons that stand between two patches
  interreflection,  ///< light that is reflected more than once before it is seen
  colour,           ///< bands that differ
  reach,            ///< rooms that no light can enter
  backs,            ///< sides that look into the dark
  luminaires,       ///< lamps that are no polygons
  sun,
  sky,
  textures,        ///< pictures on surfaces: a reflectance for each patch, else one mean for each picture
  mirrors,         ///< light that mirrors and clear faces reflect without scattering it
  closure,         ///< correction of form factors so that rows sum up to what is seen
  bands_of_panes,  ///< the colour of light that goes from patch to patch by way of clear faces and mirrors
  spectra,         ///< bands of wavelengths instead of linear RGB; decided when the scene is read
  gloss,           ///< of materials that a file says are partly mirrors; not simulated, so below
  glass            ///< of materials that a file says are transparent
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
  std::vector<Effect> skip = {};   ///< effects that are left out; none that is forced
};

/// Whether an effect is simulated, and why.
struct Decision {
  Effect effect = Effect::occlusion;
  bool simulate = true;
  std::string reason = {};  ///< the fact that decides
  std::string saving = {};  ///< what it costs to simulate it or what is saved by leaving it out, in words
  bool forced = false;      ///< the request overrules the fact
};

/// "occlusion: skipped by force; 6 of 12 faces can stand between two patches".
std::string sentence(const Decision& decision);

}  // namespace patchlight
