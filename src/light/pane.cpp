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

// For one polarization.
struct Shares {
  double transmitted = 0;
  double reflected = 0;
};

// The geometric series of the ways between both surfaces: T = t^2 a / (1 - r^2 a^2), R = r (1 + t^2 a^2 / (1 - r^2
// a^2)). A surface has the reflectance r = 1 - t, and a is the share that is left after one way across.
Shares shares_of(double t, double a) {
  const double r = 1 - t;
  const double left = (t + r * (1 - a)) * (1 + r * a);  // 1 - r^2 a^2
  if (!(left > 0)) return {0, 1};
  const double once = t * t * a / left;
  return {once, r * (1 + a * once)};
}

// The mean of both polarizations.
Shares unpolarised(const Pane& pane, double cosine) {
  const double sine_inside = std::sqrt(std::fmax(0, 1 - cosine * cosine)) / pane.index;
  const double cosine_inside = std::sqrt(1 - sine_inside * sine_inside);
  // Holes in a sheet without thickness are the same share of it from everywhere.
  const double a = pane.index == 1 ? pane.internal : std::pow(pane.internal, 1 / cosine_inside);
  Shares mean;
  for (const double t : through_surface(pane.index, cosine, cosine_inside)) {
    const Shares shares = shares_of(t, a);
    mean.transmitted += shares.transmitted / 2;
    mean.reflected += shares.reflected / 2;
  }
  return mean;
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

double transmittance(const Pane& pane, double cosine) { return unpolarised(pane, cosine).transmitted; }

double specular_reflectance(const Pane& pane, double cosine) { return unpolarised(pane, cosine).reflected; }

std::vector<Pane> panes_of(double index, const Spectrum& transmittance) {
  std::vector<Pane> panes;
  for (const double share : transmittance) panes.push_back(pane_of(index, share));
  return panes;
}

Spectrum transmittance(const std::vector<Pane>& panes, double cosine) {
  Spectrum share(static_cast<Eigen::Index>(panes.size()));
  for (std::size_t band = 0; band < panes.size(); ++band)
    share[static_cast<Eigen::Index>(band)] = transmittance(panes[band], cosine);
  return share;
}

Spectrum specular_reflectance(const std::vector<Pane>& panes, double cosine) {
  Spectrum share(static_cast<Eigen::Index>(panes.size()));
  for (std::size_t band = 0; band < panes.size(); ++band)
    share[static_cast<Eigen::Index>(band)] = specular_reflectance(panes[band], cosine);
  return share;
}

double nonspecular_rest(double specular) { return std::max(1e-6, 1 - specular); }

double cosine_of_step(std::size_t step) { return (static_cast<double>(step) + 0.5) / cosine_steps; }

// The irradiance up to a cosine is its square.
double irradiance_of_step(std::size_t step) { return 2 * cosine_of_step(step) / cosine_steps; }

Spectrum hemispherical_nonspecular(const std::vector<Pane>& panes, bool reflections_go_on) {
  Spectrum nonspecular = Spectrum::Zero(static_cast<Eigen::Index>(panes.size()));
  for (std::size_t k = 0; k < cosine_steps; ++k) {
    Spectrum onward = transmittance(panes, cosine_of_step(k));
    if (reflections_go_on) onward += specular_reflectance(panes, cosine_of_step(k));
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
