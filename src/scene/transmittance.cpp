#include "scene/transmittance.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

std::vector<Pane> panes_of(const Material& material) {
  std::vector<Pane> panes;
  for (const double share : material.transmittance) panes.push_back(pane_of(material.index, share));
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

double cosine_between(const Vector& normal, const Vector& direction) {
  return std::min(1.0, std::abs(normal.dot(direction)));
}

double held_of(double transmittance) {
  constexpr double least = 1e-6;
  return std::max(least, 1 - transmittance);
}

double cosine_of_step(std::size_t step) { return (static_cast<double>(step) + 0.5) / cosine_steps; }

// That up to a cosine is its square.
double irradiance_of_step(std::size_t step) { return 2 * cosine_of_step(step) / cosine_steps; }

Spectrum hemispherical_held(const std::vector<Pane>& panes, bool reflections_go_on) {
  Spectrum held = Spectrum::Zero(static_cast<Eigen::Index>(panes.size()));
  for (std::size_t k = 0; k < cosine_steps; ++k) {
    Spectrum onward = transmittance(panes, cosine_of_step(k));
    if (reflections_go_on) onward += specular_reflectance(panes, cosine_of_step(k));
    held += irradiance_of_step(k) * onward.unaryExpr(&held_of);
  }
  return held;
}

}  // namespace patchlight
