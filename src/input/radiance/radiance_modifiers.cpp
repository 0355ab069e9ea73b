#include "input/radiance/radiance_modifiers.h"

#include "input/radiance/radiance_material.h"

#include <algorithm>
#include <array>

namespace patchlight {
namespace {

constexpr std::array pattern_kinds = {"brightdata", "brightfunc", "brighttext", "colordata", "colorfunc",
                                      "colorpict",  "colortext",  "texdata",    "texfunc"};

bool is_pattern(const RadianceModifier& modifier) {
  return std::find(pattern_kinds.begin(), pattern_kinds.end(), modifier.kind) != pattern_kinds.end();
}

void require_numbers(const RadiancePrimitive& primitive, const std::string& where) {
  const std::size_t least = least_arguments(primitive.kind);
  if (primitive.numbers.size() >= least) return;
  throw InputError(where, primitive.kind + " " + primitive.name + " has " + std::to_string(primitive.numbers.size()) +
                              " numbers; expected " + std::to_string(least));
}

}  // namespace

void RadianceModifiers::define(const RadiancePrimitive& primitive, const std::string& where) {
  RadianceModifier modifier{all_.size(), primitive.kind, primitive.name, primitive.numbers};
  if (primitive.kind == "alias") {
    const std::optional<std::size_t> original = place_of(primitive.words[0]);
    if (!original)
      throw InputError(where,
                       "alias " + primitive.name + " stands for " + primitive.words[0] +
                           ", which is not defined before it\nhint: name the file that defines it before this one");
    modifier = all_[*original];
    modifier.name = primitive.name;
    if (modifier.under == *original) modifier.under = all_.size();
  } else {
    require_numbers(primitive, where);
  }
  // An alias keeps what modifies its original unless it has a modifier of its own.
  modifier.under = place_of(primitive.modifier).value_or(modifier.under);
  last_[primitive.name] = all_.size();
  all_.push_back(std::move(modifier));
}

std::optional<std::size_t> RadianceModifiers::place_of(const std::string& name) const {
  const auto found = last_.find(name);
  return found == last_.end() ? std::nullopt : std::optional(found->second);
}

std::size_t RadianceModifiers::material_below(std::size_t place) const {
  while (is_pattern(all_[place]) && all_[place].under != place) place = all_[place].under;
  return place;
}

bool RadianceModifiers::has_pattern(std::size_t place) const {
  return is_pattern(all_[place]) || is_pattern(all_[all_[place].under]);
}

}  // namespace patchlight
