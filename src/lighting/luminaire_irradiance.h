#pragma once

#include "lighting/receiver.h"

#include <optional>

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

}  // namespace patchlight
