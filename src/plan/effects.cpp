#include "patchlight/plan/effects.h"

#include <algorithm>

namespace patchlight {
namespace {

const char* word_for(const Decision& decision) {
  if (decision.forced) return decision.simulate ? "enabled by option" : "disabled by option";
  return decision.simulate ? "simulated" : "left out";
}

}  // namespace

std::vector<Effect> simulated_effects() {
  return {Effect::occlusion, Effect::interreflection, Effect::colour, Effect::reach,
          Effect::backs,     Effect::luminaires,      Effect::sun,    Effect::sky,
          Effect::textures,  Effect::mirrors,         Effect::closure};
}

const char* name_of(Effect effect) {
  switch (effect) {
    case Effect::occlusion:
      return "occlusion";
    case Effect::interreflection:
      return "interreflection";
    case Effect::colour:
      return "color";
    case Effect::reach:
      return "reach";
    case Effect::backs:
      return "backs";
    case Effect::luminaires:
      return "luminaires";
    case Effect::sun:
      return "sun";
    case Effect::sky:
      return "sky";
    case Effect::closure:
      return "closure";
    case Effect::textures:
      return "textures";
    case Effect::mirrors:
      return "mirrors";
    case Effect::bands_of_panes:
      return "color of panes";
    case Effect::spectra:
      return "spectra";
    case Effect::gloss:
      return "gloss";
    case Effect::glass:
      return "glass";
  }
  return "";
}

bool contains(const std::vector<Effect>& effects, Effect effect) {
  return std::find(effects.begin(), effects.end(), effect) != effects.end();
}

std::string sentence(const Decision& decision) {
  return std::string(name_of(decision.effect)) + ": " + word_for(decision) + "; " + decision.reason;
}

}  // namespace patchlight
