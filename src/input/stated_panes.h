#pragma once

#include "patchlight/scene/scene.h"

#include <string>

namespace patchlight {

/// The index of refraction that a file states where a clear material may have it, from ice to diamond; else another
/// one: programs write 1 for what they do not know.
double plausible_index(double stated, double otherwise = usual_index);

/// The transmittance at normal incidence of a pane of an index of refraction that absorbs nothing.
double highest_transmittance(double index);

/// The material as the pane that a model file makes of it by this statement. Of the transmittance what is not in [0, 1]
/// becomes the nearest number there.
Material as_pane(Material material, const Spectrum& transmittance, double index, std::string statement);

/// The material without the pane that a model file makes of it: opaque.
Material without_stated_pane(Material material);

/// The scene of one model file, of which panes that let all light through are opaque where more than half of the
/// materials are such: programs write that who mean the contrary. A note says so.
Scene without_doubtful_panes(Scene scene);

/// The scene with all settings, of which the panes that files state reflect no more than what they do not let through.
/// One note names them and the setting that makes them opaque, another one those that reflect less by that.
Scene with_stated_panes(Scene scene);

}  // namespace patchlight
