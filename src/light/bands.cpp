#include "patchlight/light/spectrum.h"

namespace patchlight {

Bands usual_bands(Eigen::Index number) {
  // ITU-R Recommendation BT.709.
  if (number == 3) return {{"r", 0.2126, {1, 0, 0}}, {"g", 0.7152, {0, 1, 0}}, {"b", 0.0722, {0, 0, 1}}};
  Bands bands;
  const double part = 1 / static_cast<double>(number);
  for (Eigen::Index band = 1; band <= number; ++band) bands.push_back({std::to_string(band), part, {part, part, part}});
  return bands;
}

}  // namespace patchlight
