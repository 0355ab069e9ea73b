#include "cli/text_table.h"

#include "cli/messages.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace patchlight::cli {

std::string text_table(const std::vector<TextRow>& cells) {
  std::vector<std::size_t> width(cells.front().size());
  std::vector<TextRow> rows = cells;
  for (TextRow& row : rows) {
    for (std::string& cell : row) cell = shown_name(cell);
  }
  for (const TextRow& row : rows) {
    for (std::size_t column = 0; column < row.size(); ++column) {
      width[column] = std::max(width[column], row[column].size());
    }
  }
  std::ostringstream text;
  text << std::left;
  for (const TextRow& row : rows) {
    for (std::size_t column = 0; column + 1 < row.size(); ++column) {
      text << std::setw(static_cast<int>(width[column]) + 2) << row[column];
    }
    text << row.back() << '\n';
  }
  return text.str();
}

}  // namespace patchlight::cli
