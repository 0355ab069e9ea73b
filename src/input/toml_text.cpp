#include "input/toml_text.h"

#include "base/shortest.h"

#include <cmath>

namespace patchlight {

std::string toml_text(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') result += '\\';
    const bool is_control = static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f;
    result += is_control ? '?' : letter;
  }
  return result + "\"";
}

std::string toml_text(const Point& point) {
  std::string text = "[";
  for (const double value : point)
    text += (text.size() > 1 ? ", " : "") + shortest(std::round(1000 * value) / 1000 + 0.0);
  return text + "]";
}

}  // namespace patchlight
