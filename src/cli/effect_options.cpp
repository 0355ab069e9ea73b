#include "cli/effect_options.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

std::string names(const std::string& separator) {
  std::string list;
  for (const Effect effect : simulated_effects()) list += (list.empty() ? "" : separator) + name_of(effect);
  return list;
}

Effect effect_named(const std::string& option, const std::string& text) {
  std::vector<std::pair<std::string, Effect>> allowed;
  for (const Effect effect : simulated_effects()) allowed.emplace_back(name_of(effect), effect);
  return choice<Effect>(option, text, allowed);
}

bool contains(const std::vector<Effect>& effects, Effect effect) {
  return std::find(effects.begin(), effects.end(), effect) != effects.end();
}

void add_effects(CLI::App& command, const std::string& option, const std::string& help, std::vector<Effect>& effects) {
  command
      .add_option_function<std::vector<std::string>>(
          option,
          [option, &effects](const std::vector<std::string>& words) {
            for (const std::string& word : words) effects.push_back(effect_named(option, word));
          },
          help)
      ->allow_extra_args(false)
      ->option_text("EFFECT");
}

}  // namespace

void add_effect_options(CLI::App& command, Request& request) {
  add_effects(command, "--force",
              "simulates an effect even where the scene does not call for it:\n" + names(", ") +
                  ";\nmay be repeated; default: as the scene calls for",
              request.force);
  add_effects(command, "--skip",
              "leaves an effect out that the scene calls for; the same words; may be\nrepeated; default: none",
              request.skip);
}

void require_consistent_effects(const Request& request) {
  for (const Effect effect : request.force) {
    const std::string name = name_of(effect);
    if (contains(request.skip, effect))
      throw UsageError("--force " + name + " and --skip " + name + " exclude each other; give one of them");
  }
  for (const Effect effect : {Effect::reach, Effect::backs}) {
    if (request.sides == Sides::automatic) break;
    const char* const option = contains(request.force, effect)  ? "--force "
                               : contains(request.skip, effect) ? "--skip "
                                                                : nullptr;
    if (option != nullptr)
      throw UsageError(option + std::string(name_of(effect)) + " and --sides exclude each other; give one of them");
  }
  if (!contains(request.force, Effect::closure)) return;
  const char* const other = !request.close ? "--no-closure" : request.on_demand ? "--on-demand" : nullptr;
  if (other != nullptr)
    throw UsageError(std::string("--force closure and ") + other + " exclude each other; give one of them");
}

}  // namespace patchlight::cli
