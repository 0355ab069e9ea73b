#include "plan/lamp_names.h"

#include "base/near_match.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace patchlight {
namespace {

constexpr std::array lamp_words = {"lights",       "lamp",     "lamps",     "desklamp",  "floorlamp",  "emit",
                                   "emitter",      "emitters", "emission",  "emissive",  "glow",       "emitting",
                                   "glowing",      "bulb",     "bulbs",     "neon",      "luminous",   "lightbulb",
                                   "ceilinglight", "led",      "spotlight", "downlight", "floodlight", "arealight"};

// Compounds, those of other languages among them, end in these.
constexpr std::array lamp_endings = {"lampe", "lampen", "leuchte", "leuchten", "luminaire", "luminaires"};

// After "light" these make a colour or a kind of material.
constexpr std::array<std::string_view, 24> light_things = {
    "grey", "gray", "brown", "blue",  "green", "red",      "yellow", "beige",  "pink", "orange", "purple", "cyan",
    "wood", "oak",  "pine",  "maple", "stone", "concrete", "brick",  "marble", "tan",  "weight", "steel",  "metal"};

bool is_small_letter(char letter) { return letter >= 'a' && letter <= 'z'; }

bool is_capital_letter(char letter) { return letter >= 'A' && letter <= 'Z'; }

// In small letters.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (std::size_t k = 0; k < name.size(); ++k) {
    const bool is_letter =
        is_small_letter(name[k]) || is_capital_letter(name[k]) || static_cast<unsigned char>(name[k]) >= 0x80;
    const bool begins = is_capital_letter(name[k]) && k > 0 && is_small_letter(name[k - 1]);
    if ((!is_letter || begins) && !words.back().empty()) words.emplace_back();
    if (is_letter) words.back() += name[k];
  }
  if (words.back().empty()) words.pop_back();
  for (std::string& word : words) word = in_lower_case(std::move(word));
  return words;
}

bool is_lamp_word(const std::string& word) {
  const auto ends = [&](const char* ending) { return word.ends_with(ending); };
  return std::find(lamp_words.begin(), lamp_words.end(), word) != lamp_words.end() ||
         std::any_of(lamp_endings.begin(), lamp_endings.end(), ends);
}

}  // namespace

bool is_name_of_lamp(const std::string& name) {
  const std::vector<std::string> words = words_of(name);
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (is_lamp_word(words[k])) return true;
    const bool is_of_thing =
        k + 1 < words.size() && std::find(light_things.begin(), light_things.end(), words[k + 1]) != light_things.end();
    if (words[k] == "light" && !is_of_thing) return true;
  }
  return false;
}

}  // namespace patchlight
