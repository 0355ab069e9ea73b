#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include <cstdint>
#include <optional>

namespace patchlight {

/// What the colours of a picture tell.
enum class PictureColors : std::uint8_t {
  natural,   ///< how it looks, exposed for what it shows
  luminance  ///< false colours from 0 to a round number of cd/m^2
};

/// How a picture is taken.
struct PictureOptions {
  std::optional<Camera> camera = {};  ///< in metres; none: a view that shows most of the scene
  PictureColors colors = PictureColors::natural;
};

/// A picture of a solved scene.
struct Picture {
  DisplayImage image;
  std::optional<double> brightest = {};  ///< where false colours end, cd/m^2; nothing for natural colours
};

/// Radiance in W/(m^2 sr) per patch as it is shown: that of the solution, and for a solution that has not converged
/// also an estimate of the light still under way.
Field display_radiance(const Simulation& simulation);

/// A picture of the smoothed radiance of a solved scene. `scene` is the one that was solved, and `simulation` comes
/// from simulate(). \throws Cancelled.
Picture take_picture(const Scene& scene, const Simulation& simulation, const PictureOptions& options = {},
                     const Observer& observer = {});

}  // namespace patchlight
