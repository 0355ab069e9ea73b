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
  int most_samples = 64;  ///< of a final picture's pixel: a power of two, 4 or more
};

/// A picture of a solved scene.
struct Picture {
  DisplayImage image;
  std::optional<double> brightest = {};      ///< where false colours end, cd/m^2; nothing for natural colours
  Image radiance = {};                       ///< what it shows, W/(m^2 sr)
  double exposure = 1;                       ///< of natural colours: display values are this times the radiance
  Camera camera = {};                        ///< that it was taken with, metres
  bool unfinished = false;                   ///< stopped by the observer: a final picture with larger errors
  std::optional<double> reached_error = {};  ///< of a final picture: root mean square over its pixels of their errors,
                                             ///< each relative as PictureOptions::error is
};

/// Radiance in W/(m^2 sr) per patch as it is shown: that of the solution, and for a solution that has not converged
/// also an estimate of the light still under way.
Field display_radiance(const Simulation& simulation);

/// Scale that maps radiance to display values, as Picture::exposure, for the patches of a solved scene: by its area,
/// nine tenths of what sends out light stay below 0.7 of the display's white. By day what counts is
/// Simulation::enclosed, as long as some of it is lit: outside, all is so much brighter.
double exposure_of(const Simulation& simulation);

/// A picture of a solved scene. `simulation` comes from simulate(). A final one
/// that the observer stops is what is there by then; before there is anything, Cancelled is thrown. \throws Cancelled;
/// InputError for a camera that is none.
Picture take_picture(const Simulation& simulation, const PictureOptions& options = {}, const Observer& observer = {});

/// A picture of a model as it is, without light: each point as bright as its reflectance times its ambient occlusion
/// (SolvedSurface::ambient_occlusion) within a distance in metres. Of the options camera, width and height count.
/// \throws InputError for a camera that is none.
Picture ambient_picture(const Scene& scene, const PictureOptions& options, double distance);

/// How a lightmap is baked.
struct LightmapOptions {
  std::optional<double> texel =
      {};  ///< edge of its texels in metres, larger where a map of 4096 x 4096 cannot hold them;
           ///< none: the smallest for which the map has 256 x 256
           ///< texels, or more where a scene has many groups of coplanar faces
};

/// The light on all surfaces of a solved scene but clear ones, for engines that show it in real time: gathered at each
/// texel as in a final picture. `simulation` comes from simulate(). Takes 44
/// bytes for each texel with three bands. \throws Cancelled; InputError when there are more groups of coplanar faces
/// than the largest map has charts for.
Lightmap bake_lightmap(const Simulation& simulation, const LightmapOptions& options = {},
                       const Observer& observer = {});

}  // namespace patchlight
