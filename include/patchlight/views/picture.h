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

/// Where the light of a picture comes from.
enum class PictureQuality : std::uint8_t {
  draft,  ///< the smoothed solution
  final   ///< what each point gets: straight from lights by shadow rays, and what patches reflect by a final gather
};

/// How a picture is taken.
struct PictureOptions {
  std::optional<Camera> camera = {};  ///< in metres; none: a view that shows most of the scene
  PictureColors colors = PictureColors::natural;
  int width = 800;   ///< pixels
  int height = 800;  ///< pixels
  PictureQuality quality = PictureQuality::draft;
  double error = 0.01;  ///< of a final picture: wanted standard error of a pixel's luminance, as a share of it or of a
                        ///< twentieth of the luminance below which nine of ten pixels stay
};

/// A picture of a solved scene.
struct Picture {
  DisplayImage image;
  std::optional<double> brightest = {};  ///< where false colours end, cd/m^2; nothing for natural colours
  Image radiance = {};                   ///< what it shows, W/(m^2 sr)
  double exposure = 1;                   ///< of natural colours: display values are this times the radiance
  Camera camera = {};                    ///< that it was taken with, metres
  bool unfinished = false;               ///< stopped by the observer: a final picture with larger errors
};

/// Radiance in W/(m^2 sr) per patch as it is shown: that of the solution, and for a solution that has not converged
/// also an estimate of the light still under way.
Field display_radiance(const Simulation& simulation);

/// A picture of a solved scene. `scene` is the one that was solved, and `simulation` comes from simulate(). A final one
/// that the observer stops is what is there by then; before there is anything, Cancelled is thrown. \throws Cancelled;
/// InputError for a camera that is none.
Picture take_picture(const Scene& scene, const Simulation& simulation, const PictureOptions& options = {},
                     const Observer& observer = {});

/// A picture of a model as it is, without light: each point as bright as its reflectance times its ambient occlusion
/// (SolvedSurface::ambient_occlusion) within a distance in metres. Of the options camera, width and height count.
/// \throws InputError for a camera that is none.
Picture ambient_picture(const Scene& scene, const PictureOptions& options, double distance);

}  // namespace patchlight
