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
  natural,   ///< as it looks
  luminance  ///< false colors from 0 to a number of cd/m^2
};

/// The source of the light in a picture.
enum class PictureQuality : std::uint8_t {
  draft,  ///< the smoothed solution
  final   ///< per point: direct light by shadow rays, reflected light by a final gather
};

/// Settings of a picture.
struct PictureOptions {
  std::optional<Camera> camera = {};  ///< in meters; none: a view that shows most of the scene
  PictureColors colors = PictureColors::natural;
  std::optional<double> exposure = {};   ///< Picture::exposure; none: by the light of the picture itself
  double stops = 0;                      ///< brighter than that, in powers of two; not with `exposure`
  std::optional<double> brightest = {};  ///< Picture::brightest; none: a round number for the picture itself
  int width = 800;                       ///< pixels
  int height = 800;                      ///< pixels
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

/// The displayed radiance per patch, W/(m^2 sr): that of the solution. If the solution has not converged, it includes
/// an estimate of the remaining light.
Field display_radiance(const Simulation& simulation);

/// The exposure of a solved scene, see Picture::exposure: the factor from radiance to display values. Nine tenths of
/// the lit area stay below 0.7 of the display's white. By day only Simulation::enclosed counts if part of it is lit, as
/// the outside is much brighter.
double exposure_of(const Simulation& simulation);

/// A picture of a solved scene. `simulation` comes from simulate(). If the observer stops a final picture, the result
/// is unfinished. \throws Canceled if there is no picture yet; InputError for an invalid camera.
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

/// Bakes the light on all surfaces of a solved scene except clear ones, for real-time engines. Each texel is gathered
/// like in a final picture. `simulation` comes from simulate(). Takes 44 bytes per texel with three bands. \throws
/// Canceled; InputError if there are more groups of coplanar faces than charts in the largest map.
Lightmap bake_lightmap(const Simulation& simulation, const LightmapOptions& options = {},
                       const Observer& observer = {});

}  // namespace patchlight
