#include "transport/ray_counts.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// The error of patch i's irradiance falls with its rays, and counts by its area; with patches of very different sizes
// more rays for the large ones pay. The exponent is measured: docs/theory/ray-method.md.
constexpr double exponent = 0.4;

// The power of two next to factor A_i^0.4.
std::uint32_t rounded(double rays) {
  const double power = std::round(std::log2(std::clamp<double>(rays, fewest_rays, most_rays)));
  return 1U << static_cast<unsigned>(power);
}

}  // namespace

std::vector<std::uint32_t> ray_counts(std::span<const double> areas, int mean) {
  std::vector<double> size;
  size.reserve(areas.size());
  for (const double area : areas) size.push_back(std::pow(area, exponent));
  const auto sum = [&](double factor) {
    double all = 0;
    for (const double s : size) all += rounded(factor * s);
    return all;
  };
  // The largest factor with which there are no more rays than wanted, by bisection of its logarithm; sizes are
  // positive.
  const double wanted = 0.5 * mean * static_cast<double>(areas.size());
  const auto [least, most] = std::minmax_element(size.begin(), size.end());
  double low = std::log(fewest_rays / (2 * *most));
  double high = std::log(2 * most_rays / *least);
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    (sum(std::exp(middle)) > wanted ? high : low) = middle;
  }
  std::vector<std::uint32_t> counts;
  counts.reserve(areas.size());
  for (const double s : size) counts.push_back(rounded(std::exp(low) * s));
  return counts;
}

}  // namespace patchlight
