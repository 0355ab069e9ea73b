#include "scene/spectral_bands.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "light/photometry.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <sstream>
#include <utility>

namespace patchlight {
namespace {

// visit_lights() with the exitance of surfaces that emit less as panes.
void visit_stated_lights(Scene& scene, const auto& visit) {
  visit_lights(scene, visit);
  for (Material& material : scene.materials) {
    if (material.stated_pane && material.stated_pane->matt_exitance.size() > 0)
      visit(material.stated_pane->matt_exitance, material.spectra.light.get());
  }
}

std::string name_of_band(double from, double to) {
  std::ostringstream text;
  text.precision(4);
  text << from << '-' << to << " nm";
  return text.str();
}

bool is_even(const Spectrum& spectrum) { return (spectrum == spectrum[0]).all(); }

Cells sum_of(const std::vector<Cells>& lights) {
  return std::accumulate(lights.begin(), lights.end(), Cells(Cells::Zero()));
}

// How light is spread inside of bands: as that of all lights together, each as bright as any other.
Cells mean_light(const Scene& scene) {
  const Cells sum = sum_of(spread_of_lights(scene));
  return (sum > 0).any() ? sum : in_cells(*illuminant_d65_spectrum(), Beyond::zero);
}

// Bands of all visible light are scaled to the luminance of the color; others leave out the light beyond them.
Spectrum in_bands_of(const WavelengthBands& to, const Bands& bands, const Spectrum& rgb,
                     const SampledSpectrum* spectrum) {
  const Spectrum values = to.sum_of(light_in_cells(rgb, spectrum));
  const double found = luminance(values, bands);
  return found > 0 && to.are_of_all_light() ? Spectrum(luminance(rgb) / found * values) : values;
}

Spectrum share_in_bands(const WavelengthBands& to, Eigen::Index number, const Spectrum& rgb,
                        const SampledSpectrum* spectrum) {
  if (!spectrum && is_even(rgb)) return Spectrum::Constant(number, rgb[0]);
  return to.mean_of(share_in_cells(rgb, spectrum)).max(0.0).min(1.0);
}

// All shares of light together are 1 at most. In a band they may be more where in linear RGB they were not.
Scene with_kept_sums(Scene scene) {
  for (Material& material : scene.materials) {
    const Spectrum stated = material.reflectance;
    for (const Spectrum* other :
         {&material.transmittance, &material.specular_reflectance, &material.diffuse_transmittance}) {
      if (other->size() > 0) material.reflectance = material.reflectance.min((1 - *other).max(0.0));
    }
    Eigen::Index band = 0;
    if (stated.size() == 0 || (stated - material.reflectance).maxCoeff(&band) <= tolerance_of_shapes) continue;
    scene.diagnostics.push_back(
        {DiagnosticCode::lowered_reflectance,
         "material '" + material.name + "': reflectance and transmittance sum to more than 1, e.g. in " +
             scene.bands[static_cast<std::size_t>(band)].name + "; there it scatters " +
             rounded(material.reflectance[band], 2) + " instead of " + rounded(stated[band], 2)});
  }
  return scene;
}

// The light on the ground below the horizon, in the bands of sun and sky.
Spectrum light_on_ground(const Scene& scene, Eigen::Index bands) {
  Spectrum lit = Spectrum::Zero(bands);
  if (scene.sky->horizontal_irradiance.size() > 0) lit += scene.sky->horizontal_irradiance;
  if (scene.sky->zenith_radiance.size() > 0) lit += scene.sky->zenith_radiance;
  if (scene.sun) lit += std::max(0.0, scene.sun->direction.dot(scene.up)) * scene.sun->normal_irradiance;
  return lit;
}

// The ground below the horizon reflects sun and sky: with their color, and in the bands the same share of them as in
// linear RGB. `lit` is their luminance in linear RGB.
Spectrum ground_in_bands(const Scene& scene, Eigen::Index bands, const Spectrum& rgb, double lit) {
  const Spectrum light = light_on_ground(scene, bands);
  return lit > 0 ? Spectrum(luminance(rgb) / lit * light) : light;
}

Scene without_spectra(Scene scene) {
  for (Material& material : scene.materials) material.spectra = {};
  for (Luminaire& luminaire : scene.luminaires) luminaire.spectrum.reset();
  if (scene.sun) scene.sun->spectrum.reset();
  if (scene.sky) scene.sky->spectrum.reset();
  return scene;
}

using Range = std::pair<Eigen::Index, Eigen::Index>;  // the first band, and the one after the last

struct AllSpectra {
  std::vector<Spectrum> shares;
  std::vector<Spectrum> lights;
};

AllSpectra all_spectra(const Scene& scene) {
  AllSpectra all;
  for_all_spectra(
      scene, [&](const Spectrum& values, const SampledSpectrum*) { all.shares.push_back(values); },
      [&](const Spectrum& values, const SampledSpectrum*) {
        if ((values > 0).any()) all.lights.push_back(values);
      });
  return all;
}

bool is_dark(const std::vector<Spectrum>& lights, Eigen::Index band) {
  return std::all_of(lights.begin(), lights.end(), [&](const Spectrum& light) { return light[band] == 0; });
}

bool are_alike(const AllSpectra& all, Eigen::Index a, Eigen::Index b) {
  if (all.lights.empty() || is_dark(all.lights, a) || is_dark(all.lights, b)) return true;
  const bool same = std::all_of(all.shares.begin(), all.shares.end(), [&](const Spectrum& share) {
    return std::abs(share[a] - share[b]) <= tolerance_of_arithmetic;
  });
  if (!same) return false;
  // e_b / e_a is that of the first light that has either, for all.
  const auto is_lit = [&](const Spectrum& light) { return light[a] > 0 || light[b] > 0; };
  const Spectrum& first = *std::find_if(all.lights.begin(), all.lights.end(), is_lit);
  return std::all_of(all.lights.begin(), all.lights.end(), [&](const Spectrum& light) {
    const double here = first[a] * light[b], there = first[b] * light[a];
    return std::abs(here - there) <= tolerance_of_arithmetic * std::max(here, there);
  });
}

// A band without light is none: its neighbors go with the band that gives the values.
Eigen::Index lit_band(const std::vector<Spectrum>& lights, const Range& range) {
  for (Eigen::Index band = range.first; band < range.second; ++band) {
    if (!is_dark(lights, band)) return band;
  }
  return range.first;
}

std::vector<Range> alike_ranges(const AllSpectra& all, Eigen::Index bands) {
  std::vector<Range> ranges;
  for (Eigen::Index band = 0; band < bands; ++band) {
    if (!ranges.empty() && are_alike(all, lit_band(all.lights, ranges.back()), band)) {
      ++ranges.back().second;
    } else {
      ranges.push_back({band, band + 1});
    }
  }
  return ranges;
}

// One watt in it is spread over its parts as the lights are.
Band joined(const Bands& bands, const Range& range, const std::vector<Spectrum>& lights) {
  const Band& first = bands[static_cast<std::size_t>(range.first)];
  const Band& last = bands[static_cast<std::size_t>(range.second - 1)];
  if (range.second - range.first == 1) return first;
  Spectrum weights = Spectrum::Ones(range.second - range.first);
  const Eigen::Index lit = lit_band(lights, range);
  const auto light = std::find_if(lights.begin(), lights.end(), [lit](const Spectrum& l) { return l[lit] > 0; });
  if (light != lights.end()) weights = light->segment(range.first, weights.size());
  weights /= weights.sum();
  Band all{first.name.substr(0, first.name.find('-')) + last.name.substr(last.name.find('-')),
           0,
           {},
           {first.edges_nm[0], last.edges_nm[1]}};
  for (Eigen::Index k = 0; k < weights.size(); ++k) {
    const Band& part = bands[static_cast<std::size_t>(range.first + k)];
    all.luminous_weight += weights[k] * part.luminous_weight;
    for (std::size_t c = 0; c < 3; ++c) all.rgb[c] += weights[k] * part.rgb[c];
  }
  return all;
}

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

WavelengthBands::WavelengthBands(const std::vector<double>& edges_nm, const Cells& light) : edges_nm_(edges_nm) {
  assert(edges_nm.size() >= 2);
  const auto number = static_cast<Eigen::Index>(edges_nm.size()) - 1;
  overlap_.setZero(number, number_of_cells);
  for (Eigen::Index band = 0; band < number; ++band) {
    const double from = edges_nm[static_cast<std::size_t>(band)], to = edges_nm[static_cast<std::size_t>(band) + 1];
    for (Eigen::Index cell = 0; cell < number_of_cells; ++cell) {
      const double begin = shortest_wavelength + static_cast<double>(cell);
      overlap_(band, cell) = std::clamp(std::min(to, begin + 1) - std::max(from, begin), 0.0, 1.0);
    }
  }
  share_weights_ = overlap_ * light.matrix().asDiagonal();
  for (Eigen::Index band = 0; band < number; ++band) {
    if (!(share_weights_.row(band).sum() > 0)) share_weights_.row(band) = overlap_.row(band);
    share_weights_.row(band) /= share_weights_.row(band).sum();
  }
}

Bands WavelengthBands::bands() const {
  Bands bands;
  // The mean of the observer over each band, by the light there.
  const Eigen::Matrix3Xd xyz = observer_in_cells().matrix() * share_weights_.transpose();
  for (Eigen::Index band = 0; band < xyz.cols(); ++band) {
    const auto k = static_cast<std::size_t>(band);
    const Eigen::Vector3d of_one_watt = xyz_per_watt(xyz.col(band)) / luminous_efficacy;
    const Eigen::Vector3d rgb = rgb_from_xyz() * of_one_watt;
    bands.push_back({name_of_band(edges_nm_[k], edges_nm_[k + 1]),
                     of_one_watt.y(),
                     {rgb.x(), rgb.y(), rgb.z()},
                     {edges_nm_[k], edges_nm_[k + 1]}});
  }
  return bands;
}

bool is_number_of_bands(double number) {
  return number >= 1 && number <= static_cast<double>(number_of_cells) && number == std::floor(number);
}

std::vector<double> equal_edges(Eigen::Index number, double from, double to) {
  std::vector<double> edges;
  for (Eigen::Index k = 0; k <= number; ++k)
    edges.push_back(from + (to - from) * static_cast<double>(k) / static_cast<double>(number));
  return edges;
}

Cells light_in_cells(const Spectrum& rgb, const SampledSpectrum* spectrum) {
  Cells light = Cells::Zero();
  if (spectrum) {
    light = in_cells(*spectrum, Beyond::zero);
  } else {
    for (std::size_t k = 0; k < 3; ++k) light += rgb[static_cast<Eigen::Index>(k)] * reflectances_of_primaries()[k];
    light *= in_cells(*illuminant_d65_spectrum(), Beyond::zero);
  }
  const double found = luminance_of_cells(light);
  return found > 0 ? Cells(luminance(rgb) / found * light) : Cells(Cells::Zero());
}

Cells share_in_cells(const Spectrum& rgb, const SampledSpectrum* spectrum) {
  if (spectrum) return in_cells(*spectrum, Beyond::end);
  if (is_even(rgb)) return Cells::Constant(rgb[0]);
  Cells share = Cells::Zero();
  for (std::size_t k = 0; k < 3; ++k) share += rgb[static_cast<Eigen::Index>(k)] * reflectances_of_primaries()[k];
  return share;
}

void for_all_spectra(const Scene& scene, const OfQuantity& of_share, const OfQuantity& of_light) {
  visit_shares(scene, of_share);
  visit_lights(scene, of_light);
}

std::vector<Cells> spread_of_lights(const Scene& scene) {
  std::vector<Cells> all;
  for_all_spectra(
      scene, [](const Spectrum&, const SampledSpectrum*) {},
      [&](const Spectrum& rgb, const SampledSpectrum* spectrum) {
        Cells light = light_in_cells(rgb, spectrum);
        const double luminance = luminance_of_cells(light);
        if (!(luminance > 0)) return;
        light /= luminance;
        const double size = light.maxCoeff();
        const bool is_known = std::any_of(all.begin(), all.end(), [&](const Cells& other) {
          return ((other - light).abs() <= tolerance_of_arithmetic * size).all();
        });
        if (!is_known) all.push_back(light);
      });
  return all;
}

bool has_spectra(const Scene& scene) {
  bool found = false;
  const OfQuantity look = [&found](const Spectrum&, const SampledSpectrum* spectrum) { found = found || spectrum; };
  for_all_spectra(scene, look, look);
  return found;
}

Scene in_wavelength_bands(Scene scene, const std::vector<double>& edges_nm) {
  assert(number_of_bands(scene) == 3);
  const WavelengthBands to(edges_nm, mean_light(scene));
  const Bands bands = to.bands();
  const auto number = static_cast<Eigen::Index>(bands.size());
  visit_shares(scene, [&](Spectrum& values, const SampledSpectrum* spectrum) {
    values = share_in_bands(to, number, values, spectrum);
  });
  std::optional<Spectrum> ground;
  if (scene.sky && scene.sky->ground_radiance.size() > 0) ground = std::exchange(scene.sky->ground_radiance, {});
  const double lit = ground ? luminance(light_on_ground(scene, 3)) : 0;
  const auto take_to_bands = [&](Spectrum& values, const SampledSpectrum* spectrum) {
    values = in_bands_of(to, bands, values, spectrum);
  };
  visit_stated_lights(scene, take_to_bands);
  if (ground) scene.sky->ground_radiance = ground_in_bands(scene, number, *ground, lit);
  scene.bands = bands;
  return without_spectra(with_kept_sums(std::move(scene)));
}

Spectrum light_in_bands(const Bands& bands, const Spectrum& rgb, const SampledSpectrum* spectrum) {
  std::vector<double> edges_nm = {bands.front().edges_nm[0]};
  for (const Band& band : bands) edges_nm.push_back(band.edges_nm[1]);
  // The light in a band does not depend on its spread inside.
  return in_bands_of(WavelengthBands(edges_nm, Cells::Ones()), bands, rgb, spectrum);
}

Scene with_daylight_in_bands(Scene scene) {
  const Bands bands = scene.bands;
  const double lit = scene.sky ? luminance(light_on_ground(scene, 3)) : 0;
  if (scene.sun) {
    scene.sun->normal_irradiance = light_in_bands(bands, scene.sun->normal_irradiance, scene.sun->spectrum.get());
    scene.sun->spectrum.reset();
  }
  if (!scene.sky) return scene;
  for (Spectrum* const values : {&scene.sky->horizontal_irradiance, &scene.sky->zenith_radiance})
    if (values->size() > 0) *values = light_in_bands(bands, *values, scene.sky->spectrum.get());
  scene.sky->spectrum.reset();
  if (scene.sky->ground_radiance.size() > 0)
    scene.sky->ground_radiance =
        ground_in_bands(scene, static_cast<Eigen::Index>(bands.size()), scene.sky->ground_radiance, lit);
  return scene;
}

Scene in_rgb(Scene scene) {
  assert(number_of_bands(scene) == 3);
  const auto take_to_rgb = [](Spectrum& values, const SampledSpectrum* spectrum) {
    if (spectrum) values = luminance(values) / luminous_efficacy * rgb_of_light(*spectrum);
  };
  visit_stated_lights(scene, take_to_rgb);
  return without_spectra(std::move(scene));
}

std::vector<std::vector<Eigen::Index>> alike_bands(const std::vector<Spectrum>& spectra, Eigen::Index bands) {
  std::vector<std::vector<Eigen::Index>> groups;
  for (Eigen::Index band = 0; band < bands; ++band) {
    const auto is_alike = [&](const std::vector<Eigen::Index>& group) {
      return std::all_of(spectra.begin(), spectra.end(),
                         [&](const Spectrum& s) { return s.size() == 0 || s[band] == s[group.front()]; });
    };
    const auto found = std::find_if(groups.begin(), groups.end(), is_alike);
    if (found == groups.end()) {
      groups.push_back({band});
    } else {
      found->push_back(band);
    }
  }
  return groups;
}

Scene with_alike_bands_joined(Scene scene) {
  const AllSpectra all = all_spectra(scene);
  const Bands bands = bands_of(scene);
  const std::vector<Range> ranges = alike_ranges(all, static_cast<Eigen::Index>(bands.size()));
  if (ranges.size() == bands.size()) return scene;
  const auto number = static_cast<Eigen::Index>(ranges.size());
  visit_shares(scene, [&](Spectrum& values, const SampledSpectrum*) {
    Spectrum kept(number);
    for (Eigen::Index k = 0; k < number; ++k)
      kept[k] = values[lit_band(all.lights, ranges[static_cast<std::size_t>(k)])];
    values = kept;
  });
  const auto join_light = [&](Spectrum& values, const SampledSpectrum*) {
    Spectrum sums(number);
    for (Eigen::Index k = 0; k < number; ++k) {
      const Range& range = ranges[static_cast<std::size_t>(k)];
      sums[k] = values.segment(range.first, range.second - range.first).sum();
    }
    values = sums;
  };
  visit_stated_lights(scene, join_light);
  scene.bands.clear();
  for (const Range& range : ranges) scene.bands.push_back(joined(bands, range, all.lights));
  return scene;
}

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
