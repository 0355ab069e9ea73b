#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "visibility/occluder.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

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

/// The upward direction of a picture: `up`, or `north`, as in plans, where the camera looks along `up`.
Vector picture_up(const Camera& camera, const Vector& up, const Vector& north);

/// A view that shows most of the kept sides. If an upright side of the scene's bounds is open, the camera stands before
/// it and looks in. Otherwise it looks from a corner of the bounds, inside, at eye height, to the opposite one. Returns
/// the view with the most different polygons over the widest part of the picture.
Camera default_camera(const Scene& scene, const KeptSides& sides, const Occluder& occluder);

/// True when most of an upright side of the bounds is a hole with kept sides in its depth.
bool has_open_side(const Scene& scene, const KeptSides& sides, const Occluder& occluder);

/// The rays of a camera's picture.
class Lens {
 public:
  /// \throws InputError when eye and target are one point, or the camera shows no extent that its projection can have.
  Lens(const Camera& camera, const Vector& up, int width, int height);

  /// The ray through a place of the picture, in pixels from its upper left corner; nothing where the picture of a
  /// fisheye ends.
  std::optional<Ray> ray(double x, double y) const;

  /// How wide about a pixel is on a surface across the view so far away, meters.
  double pixel_width(double distance) const;

 private:
  Vector direction_of(double across, double above) const;

  Projection projection_;
  int width_, height_;
  Point eye_;
  Vector forward_, right_, up_;
  double scale_;  // of a pixel: in the plane at distance 1, in the unit disc, radians, or meters
  double half_angle_;
};

/// A piece of a floor and the light that it reflects.
struct FloorPiece {
  Point middle;
  PolygonIndex polygon = no_polygon;
  double light = 0;  ///< W, or another measure of how much it counts
};

/// How bright the two sides of each polygon are, per area; -1 where a side has no part.
struct SideLight {
  Eigen::VectorXd front, back;
};

/// A view inside the room with most light: of 64 places at eye height, chosen by the light of their floors, the one
/// that sees most light on surfaces, from the end of the room that sees most of them. Nothing where no place is under a
/// ceiling and enclosed nearly all around.
std::optional<Camera> inside_camera(const std::vector<FloorPiece>& floors, const SideLight& light, const Scene& scene,
                                    const Occluder& occluder);

/// The floors of a mesh and how bright sides are, by one value per patch and area; 0 for patches that do not count.
std::vector<FloorPiece> floors_of(const PatchMesh& mesh, const Eigen::VectorXd& light, const Vector& up);
/// The same of a model without light: reflectances, and areas of floors times these.
std::vector<FloorPiece> floors_of(const Scene& scene, const SideLight& light);
SideLight reflectance_of_sides(const Scene& scene, const KeptSides& sides);
SideLight light_of_sides(const PatchMesh& mesh, const Eigen::VectorXd& light, std::size_t polygons);

}  // namespace patchlight
