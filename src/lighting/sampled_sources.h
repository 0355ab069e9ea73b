#pragma once

#include "lighting/direct_irradiance.h"
#include "lighting/receiver.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// Mean irradiance of a patch by a luminaire without extent, over the part over which no other polygon lies. Points
/// of the patch are chosen by the solid angle under which the luminaire sees it, so that without shadows an isotropic
/// one leaves no variance however near it is. With `in_shadow` false nothing stands between.
Spectrum luminaire_irradiance(const Lighting& lighting, const Luminaire& luminaire, const Receiver& receiver,
                              const ReceiverSamples& samples, bool in_shadow);

/// What shadows leave of that, per band.
struct LeftByShadows {
  Spectrum share;
  Spectrum standard_error;  ///< of the share, as each sixteenth of a patch counts with its mean irradiance
};

/// By the outlines of all shadows; nothing where they are too many (Shades).
std::optional<LeftByShadows> left_by_shadows(const Lighting& lighting, const Luminaire& luminaire,
                                             const Receiver& receiver);

/// Estimates of the mean irradiance of one receiver: one row for each set of samples, one column per band.
struct Means {
  Field of_sets;
  Spectrum missed = {};  ///< what one ray more may find, W/m^2; empty: not known, or nothing
};

/// Those of a receiver, which has to live as long, with or without shadows.
using MeansBy = std::function<Means(std::span<const ReceiverSamples>, bool)>;

/// Something that gives light and is no patch.
struct SampledSource {
  std::function<MeansBy(const Receiver&)> means_at;
  std::uint32_t samples = 0;  ///< LightingOptions
  bool has_extent = false;
  int effort = 1;  ///< times the samples where rays have to find the shadows of a light without extent, or at a point
  std::function<std::optional<LeftByShadows>(const Receiver&)> left = {};  ///< on a patch, without extent
  std::function<Spectrum(const Receiver&)> unshadowed = {};                ///< in the middle, without extent
  std::function<bool(const Receiver&)> may_be_hidden = {};                 ///< with extent
};

/// Luminaires, sun and sky of a lighting, which has to live as long.
std::vector<SampledSource> sampled_sources(const Lighting& lighting, const LightingOptions& options);

}  // namespace patchlight
