#include "cli/effect_options.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"

#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

std::string names(const std::vector<Effect>& effects, const std::string& separator) {
  std::string list;
  for (const Effect effect : effects) list += (list.empty() ? "" : separator) + name_of(effect);
  return list;
}

Effect effect_named(const std::string& option, const std::string& text, const std::vector<Effect>& effects) {
  std::vector<std::pair<std::string, Effect>> allowed;
  for (const Effect effect : effects) allowed.emplace_back(name_of(effect), effect);
  return choice<Effect>(option, text, allowed);
}

// What --enable and --disable have in common.
struct EffectList {
  const std::vector<Effect>& allowed;
  std::vector<Effect>& chosen;
};

void add_effects(CLI::App& command, const std::string& option, const std::string& help, const EffectList& list) {
  command
      .add_option_function<std::vector<std::string>>(
          option,
          [option, allowed = list.allowed, &chosen = list.chosen](const std::vector<std::string>& words) {
            for (const std::string& word : words) chosen.push_back(effect_named(option, word, allowed));
          },
          help)
      ->allow_extra_args(false)
      ->option_text("EFFECT");
}

}  // namespace

std::vector<Effect> effects_but(const std::vector<Effect>& without) {
  std::vector<Effect> effects = simulated_effects();
  std::erase_if(effects, [&](Effect effect) { return effect == Effect::closure || contains(without, effect); });
  return effects;
}

void add_effect_options(CLI::App& command, Request& request, const std::vector<Effect>& effects) {
  command.option_defaults()->group("Effects");
  add_effects(command, "--enable",
              "simulates an effect even where the scene does not call for it:\n" + names(effects, ", ") +
                  ";\nmay be repeated; default: as the scene calls for",
              {effects, request.effects.force});
  add_effects(command, "--disable",
              "leaves an effect out that the scene calls for; the same words; may be\nrepeated; default: none",
              {effects, request.effects.skip});
}

}  // namespace patchlight::cli
