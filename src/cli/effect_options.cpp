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

// An option with one of these effects that another option rules out.
void require_without(const std::vector<Effect>& effects, Effect effect, const std::string& option,
                     const std::string& other) {
  if (!contains(effects, effect)) return;
  throw UsageError(option + " " + name_of(effect) + " and " + other + " exclude each other; give one of them");
}

// What --force and --skip have in common.
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
  std::erase_if(effects, [&](Effect effect) { return contains(without, effect); });
  return effects;
}

void add_effect_options(CLI::App& command, Request& request, const std::vector<Effect>& effects) {
  add_effects(command, "--force",
              "simulates an effect even where the scene does not call for it:\n" + names(effects, ", ") +
                  ";\nmay be repeated; default: as the scene calls for",
              {effects, request.force});
  add_effects(command, "--skip",
              "leaves an effect out that the scene calls for; the same words; may be\nrepeated; default: none",
              {effects, request.skip});
}

void require_consistent_effects(const Request& request, const std::string& form_factors) {
  for (const Effect effect : request.force)
    require_without(request.skip, effect, "--skip", "--force " + std::string(name_of(effect)));
  const auto require_neither = [&request](Effect effect, const std::string& other) {
    require_without(request.force, effect, "--force", other);
    require_without(request.skip, effect, "--skip", other);
  };
  if (request.sides != Sides::automatic) {
    require_neither(Effect::reach, "--sides");
    require_neither(Effect::backs, "--sides");
  }
  if (!form_factors.empty()) require_neither(Effect::occlusion, "--form-factors");
  if (!request.close) require_without(request.force, Effect::closure, "--force", "--no-closure");
  if (!keeps_entries(request.storage)) require_without(request.force, Effect::closure, "--force", "--on-demand");
}

}  // namespace patchlight::cli
