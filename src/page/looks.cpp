#include "page/looks.h"

#include "patchlight/views/picture.h"

#include "page/drawn_faces.h"
#include "page/packed.h"
#include "render/tone_map.h"
#include "views/surroundings.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

namespace patchlight {
namespace {

using Json = nlohmann::ordered_json;
using Colours = std::vector<std::array<std::uint8_t, 3>>;

// Degrees above the horizon: sky and ground meet at it.
constexpr std::array<double, 18> elevations = {-90, -60, -40, -25, -10, -0.1, 0.1, 4,  8,
                                               13,  19,  26,  34,  43,  53,   64,  76, 90};
constexpr int in_a_ring = 48;

std::vector<Vector> directions_around(const Vector& up) {
  const Vector across = up.unitOrthogonal();
  const Vector ahead = up.cross(across);
  std::vector<Vector> directions;
  for (const double elevation : elevations) {
    const double height = elevation * std::numbers::pi / 180;
    for (int k = 0; k < in_a_ring; ++k) {
      const double azimuth = 2 * std::numbers::pi * k / in_a_ring;
      const Vector level = std::cos(azimuth) * ahead + std::sin(azimuth) * across;
      directions.emplace_back(std::cos(height) * level + std::sin(height) * up);
    }
  }
  return directions;
}

Json colours_part(const Colours& colours) {
  const std::uint8_t* const first = colours.empty() ? nullptr : colours.front().data();
  return packed_array<std::uint8_t>({first, 3 * colours.size()}, 3);
}

// Radiances, one row for each direction; no rows without a sky.
Field radiance_of_sky(const SolvedSurface& surface) {
  const auto sky = sky_of(surface.simulation);
  if (!sky) return {};
  const std::vector<Vector> directions = directions_around(surface.scene.up.normalized());
  Field radiance(static_cast<Eigen::Index>(directions.size()), surface.simulation.solution.radiosity.cols());
  for (Eigen::Index row = 0; row < radiance.rows(); ++row)
    radiance.row(row) = sky(directions[static_cast<std::size_t>(row)]);
  return radiance;
}

}  // namespace

std::vector<Look> looks_of(const SolvedSurface& surface, double exposure) {
  const Simulation& simulation = surface.simulation;
  if (simulation.enclosed.size() == 0) return {{"natural", exposure}};
  const Field radiance = display_radiance(simulation);
  const Eigen::VectorXd inside = simulation.problem.area.cwiseProduct(simulation.enclosed);
  const Eigen::VectorXd outside = simulation.problem.area - inside;
  const auto is_lit = [&](const Eigen::VectorXd& weight) {
    return ((radiance.rowwise().maxCoeff() > 0) && (weight.array() > 0)).any();
  };
  if (!is_lit(inside) || !is_lit(outside)) return {{"natural", exposure}};
  const Bands bands = bands_of(surface.scene);
  const Look of_inside{"natural, exposed for the inside", exposure_for(radiance, inside, bands)};
  const Look of_outside{"natural, exposed for the outside", exposure_for(radiance, outside, bands)};
  const auto ratio = [exposure](const Look& look) { return std::abs(std::log(exposure / look.exposure)); };
  const bool for_inside = ratio(of_inside) <= ratio(of_outside);
  if (for_inside) return {{of_inside.name, exposure}, of_outside};
  return {{of_outside.name, exposure}, of_inside};
}

Json looks_part(const SolvedSurface& surface, double exposure, std::size_t most_faces) {
  const Bands bands = bands_of(surface.scene);
  const Field sky = radiance_of_sky(surface);
  Json part = Json::array();
  for (const Look& look : looks_of(surface, exposure)) {
    Json entry{{"name", look.name}, {"exposure", look.exposure}};
    entry["colours"] = colours_part(drawn_faces(surface, look.exposure, most_faces).colours);
    if (sky.rows() > 0) entry["sky"] = colours_part(tone_map(sky, look.exposure, bands));
    part.push_back(std::move(entry));
  }
  return part;
}

Json sky_directions(const SolvedSurface& surface) {
  if (!surface.scene.sky) return nullptr;
  std::vector<float> numbers;
  for (const Vector& direction : directions_around(surface.scene.up.normalized())) {
    for (const double coordinate : direction) numbers.push_back(static_cast<float>(coordinate));
  }
  return {{"in_a_ring", in_a_ring}, {"directions", packed_array<float>(numbers, 3)}};
}

}  // namespace patchlight
