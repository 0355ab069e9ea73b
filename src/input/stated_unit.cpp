#include "input/stated_unit.h"

#include "base/lower_case.h"
#include "input/text.h"

#include <array>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// What follows each of the entities with this keyword, up to the end of its list, in small letters without spaces; the
// first that is of lengths.
std::string length_entity(std::string_view text, std::string_view keyword) {
  for (std::size_t at = text.find(keyword); at != std::string_view::npos; at = text.find(keyword, at + 1)) {
    std::string list;
    for (const char letter : in_lower_case(std::string(text.substr(at, text.find(')', at) - at)))) {
      if (letter > ' ') list += letter;
    }
    if (list.find(".lengthunit.") != std::string::npos) return list;
  }
  return {};
}

}  // namespace

double collada_unit(std::string_view text) {
  const std::size_t unit = text.find("<unit");
  if (unit == std::string_view::npos) return 1;
  const std::string_view element = text.substr(unit, text.find('>', unit) - unit);
  const std::size_t key = element.find("meter=");
  if (key == std::string_view::npos || key + 7 >= element.size()) return 1;
  const std::size_t begin = key + 7;
  const std::size_t end = element.find_first_of("\"'", begin);
  const double metres = finite_number(element.substr(begin, end - begin)).value_or(1);
  return metres > 0 ? metres : 1;
}

double ifc_unit(std::string_view text) {
  const std::string converted = length_entity(text, "IFCCONVERSIONBASEDUNIT");
  if (converted.find("'foot'") != std::string::npos) return 0.3048;
  if (converted.find("'inch'") != std::string::npos) return 0.0254;
  const std::string si = length_entity(text, "IFCSIUNIT");
  constexpr std::array<std::pair<const char*, double>, 4> prefixes = {
      {{".milli.", 1e-3}, {".centi.", 1e-2}, {".deci.", 1e-1}, {".kilo.", 1e3}}};
  for (const auto& [prefix, metres] : prefixes) {
    if (si.find(prefix) != std::string::npos) return metres;
  }
  return 1;
}

}  // namespace patchlight
