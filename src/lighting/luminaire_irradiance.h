#pragma once

#include "lighting/receiver.h"

namespace patchlight {

struct LuminaireSamples {
  SamplePoints rays;    ///< choose the points of the patch that get a shadow ray
  SamplePoints places;  ///< choose those that find the share of the patch that is not covered
};

/// Mean irradiance of a patch by a luminaire without extent, over the part over which no other polygon lies. Points
/// of the patch are chosen by the solid angle under which the luminaire sees it, so that without shadows an isotropic
/// one leaves no variance however near it is.
Spectrum luminaire_irradiance(const Lighting& lighting, const Luminaire& luminaire, const Receiver& receiver,
                              const LuminaireSamples& samples);

}  // namespace patchlight
