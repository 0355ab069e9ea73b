
#include "light/photometry.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

constexpr std::array<Eigen::Index, 16> series = {4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 50, 64, 80, 100, 133, 200};

// The eye sees little beyond 400 and 720 nm: the bands at either end are wider.
std::vector<double> edges_of(Eigen::Index number) {
  std::vector<double> edges = equal_edges(number, 400, 720);
  edges.front() = shortest_wavelength;
  edges.back() = longest_wavelength;
  return edges;
}

struct Colours {
  std::vector<Cells> lights;
  std::vector<Cells> shares;  // reflectances and transmittances
};

Colours colours_of(const Scene& scene) {
  Colours colours{spread_of_lights(scene), {}};
  if (colours.lights.empty()) colours.lights.push_back(in_cells(*illuminant_d65_spectrum(), Beyond::zero));
  for_all_spectra(
      scene,
      [&](const Spectrum& rgb, const SampledSpectrum* spectrum) {
        const Cells share = share_in_cells(rgb, spectrum);
        // A gray one has no color of its own.
        if (share.maxCoeff() > share.minCoeff()) colours.shares.push_back(share);
      },
      [](const Spectrum&, const SampledSpectrum*) {});
  return colours;
}

Cells sum_of(const std::vector<Cells>& lights) {
  return std::accumulate(lights.begin(), lights.end(), Cells(Cells::Zero()));
}

// One light, exact and in bands.
class LightInBands {
 public:
  LightInBands(const Cells& light, const WavelengthBands& to, const Bands& bands)
      : light_(light), bands_(bands), in_bands_(to.sum_of(light)), white_(xyz_of_cells(light)) {
    in_bands_ *= white_.y() / luminance(in_bands_, bands);
  }

  // The color error of the share that is left of it.
  double error_of(const Cells& share, const Spectrum& in_bands) const {
    return colour_difference(lab_of(xyz_of_cells(light_ * share), white_),
                             lab_of(xyz_of(in_bands_ * in_bands, bands_), white_));
  }

 private:
  const Cells& light_;
  const Bands& bands_;
  Spectrum in_bands_;
  Eigen::Vector3d white_;
};

// The shares by the error of the color reflected once, the largest first.
std::vector<std::pair<double, std::size_t>> by_error(const LightInBands& light, const std::vector<Cells>& shares,
                                                     const std::vector<Spectrum>& in_bands) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < shares.size(); ++k) order.emplace_back(light.error_of(shares[k], in_bands[k]), k);
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  });
  return order;
}

double worst_error(const LightInBands& light, const std::vector<Cells>& shares, const std::vector<Spectrum>& in_bands,
                   Eigen::Index bands) {
  double worst = light.error_of(Cells::Ones(), Spectrum::Ones(bands));
  const std::vector<std::pair<double, std::size_t>> order = by_error(light, shares, in_bands);
  if (!order.empty()) worst = std::max(worst, order[0].first);
  // 40 materials stand for all where light is reflected twice, 12 where it is reflected three times.
  for (std::size_t i = 0; i < std::min<std::size_t>(order.size(), 40); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const std::size_t a = order[i].second, b = order[j].second;
      const Cells twice = shares[a] * shares[b];
      const Spectrum twice_in_bands = in_bands[a] * in_bands[b];
      worst = std::max(worst, light.error_of(twice, twice_in_bands));
      for (std::size_t k = 0; k <= j && i < 12; ++k) {
        const std::size_t c = order[k].second;
        worst = std::max(worst, light.error_of(twice * shares[c], twice_in_bands * in_bands[c]));
      }
    }
  }
  return worst;
}

double error_with(const Colours& colours, const std::vector<double>& edges_nm) {
  const WavelengthBands to(edges_nm, sum_of(colours.lights));
  const Bands bands = to.bands();
  std::vector<Spectrum> in_bands;
  for (const Cells& share : colours.shares) in_bands.push_back(to.mean_of(share));
  double worst = 0;
  // The light of further lamps is between these 12, or as rare.
  for (std::size_t k = 0; k < std::min<std::size_t>(colours.lights.size(), 12); ++k) {
    const LightInBands light(colours.lights[k], to, bands);
    worst = std::max(worst, worst_error(light, colours.shares, in_bands, static_cast<Eigen::Index>(bands.size())));
  }
  return worst;
}

}  // namespace

double colour_error(const Scene& scene, const std::vector<double>& edges_nm) {
  return error_with(colours_of(scene), edges_nm);
}

BandsWithError bands_within(const Scene& scene, double color_error) {
  const Colours colours = colours_of(scene);
  BandsWithError found;
  for (const Eigen::Index number : series) {
    found.edges_nm = edges_of(number);
    found.color_error = error_with(colours, found.edges_nm);
    if (found.color_error <= color_error) break;
  }
  return found;
}

}  // namespace patchlight
