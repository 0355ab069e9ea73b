#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include <cstdint>
#include <optional>

namespace patchlight {

/// The meaning of the colors of a picture.
enum class PictureColors : std::uint8_t {
  natural,   ///< as it looks, exposed for its own light
  luminance  ///< false colors from 0 to a round number of cd/m^2
};

/// Where the light of a picture comes from.
enum class PictureQuality : std::uint8_t {
  draft,  ///< the smoothed solution
  final   ///< the light of each point: straight from lights by shadow rays, and reflected by a final gather
};

/// How a picture is taken.
struct PictureOptions {
  std::optional<Camera> camera = {};  ///< in meters; none: a view that shows most of the scene
  PictureColors colors = PictureColors::natural;
  int width = 800;   ///< pixels
  int height = 800;  ///< pixels
  PictureQuality quality = PictureQuality::draft;
  double error = 0.01;  ///< of a final picture: wanted standard error of a pixel's luminance, as a share of it or of a
                        ///< twentieth of the luminance below which nine of ten pixels stay
  int most_samples = 64;  ///< of a final picture's pixel: a power of two, 4 or more
};

/// A picture of a solved scene.
struct Picture {
  DisplayImage image;
  std::optional<double> brightest = {};      ///< where false colors end, cd/m^2; nothing for natural colors
  Image radiance = {};                       ///< of its pixels, W/(m^2 sr)
  double exposure = 1;                       ///< of natural colors: display values are this times the radiance
  Camera camera = {};                        ///< that it was taken with, meters
  bool unfinished = false;                   ///< stopped by the observer: a final picture with larger errors
  std::optional<double> reached_error = {};  ///< of a final picture: root mean square over its pixels of their errors,
                                             ///< each relative as PictureOptions::error is
};

/// Radiance in W/(m^2 sr) per patch as it is shown: that of the solution, and for a solution that has not converged
/// also an estimate of the light still under way.
Field display_radiance(const Simulation& simulation);

/// Scale that maps radiance to display values, as Picture::exposure, for the patches of a solved scene: by its area,
/// nine tenths of the lit surfaces stay below 0.7 of the display's white. By day only Simulation::enclosed counts, as
/// long as some of it is lit: outside, all is so much brighter.
double exposure_of(const Simulation& simulation);

/// A picture of a solved scene. `simulation` comes from simulate(). When the observer stops a final picture, it stays
/// unfinished. \throws Cancelled before there is anything; InputError for a camera that is none.
Picture take_picture(const Simulation& simulation, const PictureOptions& options = {}, const Observer& observer = {});

/// A picture of a model without light: each point is as bright as its reflectance times its ambient occlusion
/// (SolvedSurface::ambient_occlusion) within a distance in meters. Uses the options camera, width and height. \throws
/// InputError for an invalid camera.
Picture ambient_picture(const Scene& scene, const PictureOptions& options, double distance);

/// How a lightmap is baked.
struct LightmapOptions {
  /// Edge of its texels in meters, larger where a map of 4096 x 4096 cannot hold them. None: the smallest for which the
  /// map has 256 x 256 texels, or more where a scene has many groups of coplanar faces.
  std::optional<double> texel = {};
};

/// The light on all surfaces of a solved scene but clear ones, for engines that show it in real time: gathered at each
/// texel as in a final picture. `simulation` comes from simulate(). Takes 44
/// bytes for each texel with three bands. \throws Cancelled; InputError when there are more groups of coplanar faces
/// than the largest map has charts for.
Lightmap bake_lightmap(const Simulation& simulation, const LightmapOptions& options = {},
                       const Observer& observer = {});

}  // namespace patchlight
