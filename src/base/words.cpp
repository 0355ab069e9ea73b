#include "base/near_match.h"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <vector>

namespace patchlight {
namespace {

// Number of insertions, removals and replacements that turn one word into the other (Levenshtein 1966), row by row.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string near_match(const std::string& found, std::span<const std::string> allowed) {
  std::string nearest;
  std::size_t least = 3;
  for (const std::string& word : allowed) {
    const std::size_t distance = edit_distance(word, found);
    if (distance >= least || 2 * distance >= word.size()) continue;
    least = distance;
    nearest = word;
  }
  return nearest;
}

std::string suggestion(const std::string& found, std::span<const std::string> allowed) {
  const std::string nearest = near_match(found, allowed);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

namespace {

constexpr std::string_view plain_letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./,:=-+@%";

}  // namespace

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(plain_letters) == std::string::npos) return word;
  // Within quotes a quote cannot stand: they are closed before it, and opened again after it.
  std::string text = "'";
  for (const char letter : word) text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

}  // namespace patchlight
