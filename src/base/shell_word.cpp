#include "base/shell_word.h"

#include <string_view>

namespace patchlight {
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
