#pragma once

#include "patchlight/scene/scene.h"

#include "render/glare.h"
#include "scene/photometric_web.h"
#include "visibility/occluder.h"

#include <vector>

namespace patchlight {

/// The area in m^2 of a luminaire's luminous opening (PhotometricWeb::opening) across a unit direction, as CIE 117:1995
/// takes it for A_p; 0 of a point. Length lies along the zero plane, width across it, height along the aim (IES
/// LM-63-02).
double projected_opening(const PhotometricWeb& web, const LuminaireFrame& frame, const Vector& direction);

/// What the measured luminaires before an eye that looks along a unit direction are as sources of glare: luminance
/// I / A_p, solid angle A_p / d^2, CIE 117:1995, in sixteen parts each, as far as the eye sees them. Lamps without
/// extent are left out. `upward` is unit and at right angles to `forward`.
std::vector<GlareSource> luminaire_glare(const Scene& scene, const Occluder& faces, const Point& eye,
                                         const Vector& forward, const Vector& upward);

}  // namespace patchlight
