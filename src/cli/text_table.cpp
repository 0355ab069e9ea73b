#include "cli/messages.h"

#include <algorithm>

namespace patchlight::cli {
namespace {

// Number of UTF-8 characters: continuation bytes do not count.
std::size_t length_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }));
}

}  // namespace

std::string text_table(const std::vector<TextRow>& cells) {
  std::vector<std::size_t> width(cells.front().size());
  std::vector<TextRow> rows = cells;
  for (TextRow& row : rows) {
    for (std::string& cell : row) cell = shown_name(cell);
  }
  for (const TextRow& row : rows) {
    for (std::size_t column = 0; column < row.size(); ++column)
      width[column] = std::max(width[column], length_of(row[column]));
  }
  std::string text;
  for (const TextRow& row : rows) {
    for (std::size_t column = 0; column + 1 < row.size(); ++column)
      text += row[column] + std::string(width[column] + 2 - length_of(row[column]), ' ');
    text += row.back() + '\n';
  }
  return text;
}

}  // namespace patchlight::cli
