#include "base/rounded.h"

#include <cmath>
#include <iomanip>
#include <sstream>

namespace patchlight {

std::string rounded(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::ostringstream text;
  text << std::setprecision(digits) << value;
  return text.str();
}

std::string percent(double share, int digits) { return rounded(100 * share, digits); }

}  // namespace patchlight
