#include "scene/joined_bands.h"

#include "scene/all_spectra.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

using Range = std::pair<Eigen::Index, Eigen::Index>;  // the first band, and the one after the last

// What rounding makes of numbers of about 1.
constexpr double same_within = 1e-12;

struct AllSpectra {
  std::vector<Spectrum> shares;
  std::vector<Spectrum> lights;
};

AllSpectra all_spectra(const Scene& scene) {
  Scene copy = without_geometry(scene);
  AllSpectra all;
  visit_shares(copy, [&](const Spectrum& values, const SampledSpectrum*) { all.shares.push_back(values); });
  visit_lights(copy, [&](const Spectrum& values, const SampledSpectrum*) {
    if ((values > 0).any()) all.lights.push_back(values);
  });
  return all;
}

bool is_dark(const std::vector<Spectrum>& lights, Eigen::Index band) {
  return std::all_of(lights.begin(), lights.end(), [&](const Spectrum& light) { return light[band] == 0; });
}

bool are_alike(const AllSpectra& all, Eigen::Index a, Eigen::Index b) {
  if (all.lights.empty() || is_dark(all.lights, a) || is_dark(all.lights, b)) return true;
  const bool same = std::all_of(all.shares.begin(), all.shares.end(),
                                [&](const Spectrum& share) { return std::abs(share[a] - share[b]) <= same_within; });
  if (!same) return false;
  // e_b / e_a is that of the first light that has either, for all.
  const auto is_lit = [&](const Spectrum& light) { return light[a] > 0 || light[b] > 0; };
  const Spectrum& first = *std::find_if(all.lights.begin(), all.lights.end(), is_lit);
  return std::all_of(all.lights.begin(), all.lights.end(), [&](const Spectrum& light) {
    const double here = first[a] * light[b], there = first[b] * light[a];
    return std::abs(here - there) <= same_within * std::max(here, there);
  });
}

// A band without light is none: what is beside it goes with the band that gives the values.
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
  const bool is_lit = !lights.empty() && !is_dark(lights, lit_band(lights, range));
  if (is_lit) {
    const Eigen::Index lit = lit_band(lights, range);
    const auto light = std::find_if(lights.begin(), lights.end(), [lit](const Spectrum& l) { return l[lit] > 0; });
    weights = light->segment(range.first, weights.size());
  }
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

}  // namespace

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
  visit_lights(scene, join_light);
  visit_matt_lights(scene, join_light);
  scene.bands.clear();
  for (const Range& range : ranges) scene.bands.push_back(joined(bands, range, all.lights));
  return scene;
}

}  // namespace patchlight
