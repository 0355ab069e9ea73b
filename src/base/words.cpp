#include "base/words.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <numeric>
#include <sstream>
#include <string_view>
#include <vector>

namespace patchlight {
namespace {

constexpr std::string_view plain_letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./,:=-+@%";

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

std::string shortest(double number) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
  return {text.data(), end};
}

std::string rounded(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  // 2000 rather than 2e+03.
  constexpr double least_with_exponent = 1e6;
  const double size = std::abs(value);
  const double step =
      size < least_with_exponent && size >= 1 ? std::pow(10, std::floor(std::log10(size)) - digits + 1) : 0;
  std::ostringstream text;
  if (step > 1) {
    text << std::fixed << std::setprecision(0) << std::round(value / step) * step;
  } else {
    text << std::setprecision(digits) << value;
  }
  return text.str();
}

std::string percent(double share, int digits) { return rounded(100 * share, digits); }

std::string listed(std::span<const std::string> texts, const std::string& separator) {
  return listed_as(
      texts, [](const std::string& text) { return text; }, separator);
}

std::string first_few(std::span<const std::string> texts, std::size_t few) {
  if (texts.size() <= few) return listed(texts);
  return listed(texts.first(few)) + " and " + std::to_string(texts.size() - few) + " more";
}

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

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(plain_letters) == std::string::npos) return word;
  // Within quotes a quote cannot stand: they are closed before it, and opened again after it.
  std::string text = "'";
  for (const char letter : word) text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

}  // namespace patchlight
