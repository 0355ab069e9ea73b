#pragma once

#include "patchlight/scene/scene.h"

#include <vector>

namespace patchlight {

/// Bands of wavelengths, and how far colours are off by them.
struct BandsWithError {
  std::vector<double> edges_nm;
  double color_error = 0;  ///< CIE dE00, see colour_error()
};

/// How far bands with these edges put colours off at most, CIE dE00: of light of each lamp of the scene, which is in
/// linear RGB, as it is, and reflected by one, two or three surfaces, seen beside a white under that lamp. Of many
/// materials those that are most off by themselves stand for all where light is reflected more than once.
double colour_error(const Scene& scene, const std::vector<double>& edges_nm);

/// The fewest bands, of a series from 4 to 200, that keep colour_error() within one that is above 0; else the most.
BandsWithError bands_within(const Scene& scene, double color_error);

}  // namespace patchlight
