#include "output/report/csv_cell.h"

#include <cmath>
#include <sstream>

namespace patchlight {

std::string csv_cell(const std::string& name) {
  const bool is_formula = !name.empty() && std::string("=+-@\t\r\n").find(name[0]) != std::string::npos;
  const std::string text = is_formula ? "'" + name : name;
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (const char letter : text) quoted.append(letter == '"' ? 2 : 1, letter);
  return quoted + '"';
}

std::string csv_cell(double number) {
  if (!std::isfinite(number)) return {};
  std::ostringstream text;
  text.precision(9);
  text << number;
  return text.str();
}

}  // namespace patchlight
