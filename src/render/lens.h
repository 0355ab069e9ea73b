#pragma once

#include "patchlight/scene/scene.h"

#include "visibility/occluder.h"

#include <array>
#include <cstdint>
#include <optional>

namespace patchlight {

/// Point `index` of a four-dimensional Owen-scrambled Sobol sequence that belongs to `seed`, in shuffled order: any
/// aligned block of a power of two of its points is stratified, and sequences of different seeds have nothing to do
/// with each other. Repeats after 4,096. Burley 2020, Practical Hash-based Owen Scrambling, section 5.
std::array<double, 4> pixel_sample(std::uint32_t index, std::uint32_t seed);

/// Its first two coordinates, in half the time.
std::array<double, 2> pixel_sample_2d(std::uint32_t index, std::uint32_t seed);

/// A number of (0, 1) moved to the density 1 - |x| of (-1, 1): a pixel's place under the tent filter, so that each of
/// its samples counts alike (Ernst, Stamminger and Greiner 2006, Filter Importance Sampling).
double tent(double u);

/// What is upward in a picture: `up`, or where that is the way the camera looks, `north`, as in plans.
Vector picture_up(const Camera& camera, const Vector& up, const Vector& north);

/// The rays of a camera's picture.
class Lens {
 public:
  /// \throws InputError when eye and target are one point, or the camera shows no extent that its projection can have.
  Lens(const Camera& camera, const Vector& up, int width, int height);

  /// The ray through a place of the picture, in pixels from its upper left corner; nothing where the picture of a
  /// fisheye ends.
  std::optional<Ray> ray(double x, double y) const;

  /// How wide about a pixel is on a surface across the view so far away, metres.
  double pixel_width(double distance) const;

 private:
  Vector direction_of(double across, double above) const;

  Projection projection_;
  int width_, height_;
  Point eye_;
  Vector forward_, right_, up_;
  double scale_;  // of a pixel: in the plane at distance 1, in the unit disc, radians, or metres
  double half_angle_;
};

}  // namespace patchlight
