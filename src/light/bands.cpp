#include "light/bands.h"

namespace patchlight {
namespace {

constexpr Eigen::Index rgb_bands = 3;

// ITU-R Recommendation BT.709.
constexpr std::array<double, rgb_bands> rec_709 = {0.2126, 0.7152, 0.0722};

}  // namespace

double Bands::luminous_weight(Eigen::Index band) const {
  return number == rgb_bands ? rec_709[static_cast<std::size_t>(band)] : 1 / static_cast<double>(number);
}

std::array<double, 3> Bands::rgb(Eigen::Index band) const {
  if (number == rgb_bands) return {band == 0 ? 1.0 : 0.0, band == 1 ? 1.0 : 0.0, band == 2 ? 1.0 : 0.0};
  const double weight = luminous_weight(band);
  return {weight, weight, weight};
}

std::string Bands::name(Eigen::Index band) const {
  return number == rgb_bands ? std::string(1, "rgb"[band]) : std::to_string(band + 1);
}

}  // namespace patchlight
