#include "light/pane.h"

#include <array>
#include <cmath>

namespace patchlight {
namespace {

// The transmittance 1 - r of one surface for light polarized across the plane of incidence and in it: Fresnel's
// equations with Snell's law.
std::array<double, 2> through_surface(double index, double cosine, double cosine_inside) {
  if (index == 1) return {1, 1};
  const double across = cosine + index * cosine_inside;
  const double along = index * cosine + cosine_inside;
  const double product = 4 * index * cosine * cosine_inside;
  return {product / (across * across), product / (along * along)};
}

// For one polarization, by the geometric series of the reflections between both surfaces: T = t^2 a / (1 - r^2 a^2), R
// = r (1 + t^2 a^2 / (1 - r^2 a^2)). A surface has the reflectance r = 1 - t, and a is the share that is left after one
// way across.
PaneShares shares_of(double t, double a) {
  const double r = 1 - t;
  const double left = (t + r * (1 - a)) * (1 + r * a);  // 1 - r^2 a^2
  if (!(left > 0)) return {0, 1};
  const double once = t * t * a / left;
  return {once, r * (1 + a * once)};
}

// One value for each pane. Most spectra have one value for all bands, which is computed once.
template <class Value>
Spectrum each(const std::vector<Pane>& panes, const Value& value_of) {
  Spectrum values(static_cast<Eigen::Index>(panes.size()));
  for (std::size_t k = 0; k < panes.size(); ++k) {
    const auto band = static_cast<Eigen::Index>(k);
    values[band] = k > 0 && panes[k] == panes[k - 1] ? values[band - 1] : value_of(panes[k]);
  }
  return values;
}

}  // namespace

Pane pane_of(double index, double transmittance) {
  const double ratio = (index - 1) / (index + 1);
  const double r = ratio * ratio;
  if (transmittance >= (1 - r) / (1 + r)) {
    // T = (1 - r) / (1 + r) with r = ((n - 1) / (n + 1))^2
    const double root = std::sqrt((1 - transmittance) / (1 + transmittance));
    return {(1 + root) / (1 - root), 1};
  }
  // T r^2 a^2 + (1 - r)^2 a - T = 0
  const double t = (1 - r) * (1 - r);
  return {index, 2 * transmittance / (t + std::sqrt(t * t + 4 * r * r * transmittance * transmittance))};
}

PaneShares shares(const Pane& pane, double cosine) {
  const double sine_inside = std::sqrt(std::fmax(0, 1 - cosine * cosine)) / pane.index;
  const double cosine_inside = std::sqrt(1 - sine_inside * sine_inside);
  // Holes in a sheet without thickness are the same share of it from everywhere.
  const double a = pane.index == 1 ? pane.internal : std::pow(pane.internal, 1 / cosine_inside);
  PaneShares mean;
  for (const double t : through_surface(pane.index, cosine, cosine_inside)) {
    const PaneShares one = shares_of(t, a);
    mean.transmitted += one.transmitted / 2;
    mean.reflected += one.reflected / 2;
  }
  return mean;
}

double transmittance(const Pane& pane, double cosine) { return shares(pane, cosine).transmitted; }

double specular_reflectance(const Pane& pane, double cosine) { return shares(pane, cosine).reflected; }

std::vector<Pane> panes_of(double index, const Spectrum& transmittance) {
  std::vector<Pane> panes;
  for (const double share : transmittance) panes.push_back(pane_of(index, share));
  return panes;
}

Spectrum transmittance(const std::vector<Pane>& panes, double cosine) {
  return each(panes, [&](const Pane& pane) { return transmittance(pane, cosine); });
}

Spectrum specular_reflectance(const std::vector<Pane>& panes, double cosine) {
  return each(panes, [&](const Pane& pane) { return specular_reflectance(pane, cosine); });
}

double nonspecular_rest(double specular) { return std::max(1e-6, 1 - specular); }

double cosine_of_step(std::size_t step) { return (static_cast<double>(step) + 0.5) / cosine_steps; }

// The irradiance up to a cosine is its square.
double irradiance_of_step(std::size_t step) { return 2 * cosine_of_step(step) / cosine_steps; }

Spectrum hemispherical_nonspecular(const std::vector<Pane>& panes, bool reflections_go_on) {
  Spectrum nonspecular = Spectrum::Zero(static_cast<Eigen::Index>(panes.size()));
  for (std::size_t k = 0; k < cosine_steps; ++k) {
    const Spectrum onward = each(panes, [&](const Pane& pane) {
      const auto [transmitted, reflected] = shares(pane, cosine_of_step(k));
      return transmitted + (reflections_go_on ? reflected : 0);
    });
    nonspecular += irradiance_of_step(k) * onward.unaryExpr(&nonspecular_rest);
  }
  return nonspecular;
}

double hemispherical_reflectance(const Pane& pane) {
  double reflected = 0;
  for (std::size_t k = 0; k < cosine_steps; ++k)
    reflected += irradiance_of_step(k) * specular_reflectance(pane, cosine_of_step(k));
  return reflected;
}

}  // namespace patchlight
