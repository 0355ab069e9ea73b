#include "output/csv_cell.h"

namespace patchlight {

std::string csv_cell(const std::string& name) {
  const bool is_formula = !name.empty() && std::string("=+-@\t\r\n").find(name[0]) != std::string::npos;
  const std::string text = is_formula ? "'" + name : name;
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (const char letter : text) quoted.append(letter == '"' ? 2 : 1, letter);
  return quoted + '"';
}

}  // namespace patchlight
