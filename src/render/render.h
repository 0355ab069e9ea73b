#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "mesh/interpolate.h"
#include "mesh/patch_lookup.h"
#include "render/camera.h"
#include "scene/photometric_web.h"
#include "visibility/occluder.h"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace patchlight {

/// The luminous shape of a luminaire as rays see it. It is for display: it neither adds light nor casts shadows.
struct SeenLuminaire {
  Point centre;
  double reach = 0;  ///< m, from the center to its farthest point or beyond
  OpeningShape shape = OpeningShape::ellipsoid;
  Eigen::Matrix3d to_unit;                          ///< maps width, length and height to [-1, 1]
  std::function<Spectrum(const Vector&)> radiance;  ///< W/(m^2 sr) in a unit direction from it; rays pass if it is 0
};

/// A patch that a ray sees, behind clear faces or not; none where it meets nothing.
struct SeenPatch {
  std::size_t ray = 0;
  std::optional<PatchIndex> patch = {};
  Point point = Point::Zero();  ///< on the patch
  Vector direction = Vector::Zero();
  Spectrum share;                            ///< of its light that arrives, after clear faces and mirrors on the way
  bool outlook = false;                      ///< behind a clear face, or nothing is met
  double distance = 0;                       ///< along the way from the ray's origin, meters
  const SeenLuminaire* luminaire = nullptr;  ///< seen in place of a patch
};

/// The luminaires that have a size: spheres, and IES luminaires with the luminous opening of their file. The radiance
/// of an opening is its intensity in a direction over its projected area.
std::vector<SeenLuminaire> seen_luminaires(const std::vector<Luminaire>& luminaires, const Vector& up);

/// The patches that rays see: the first that each meets and, as long as that is clear or a mirror, those behind it and
/// in it. Rays pass sides without patches and end on luminaires. Roulette for weak paths follows from `keys`,
/// one per ray.
std::vector<SeenPatch> seen_by(const Occluder& occluder, const SurfaceOptics& optics, const PatchLookup& lookup,
                               const std::vector<Ray>& rays, std::span<const std::uint64_t> keys,
                               const std::vector<SeenLuminaire>& luminaires = {});

/// Patch values as a smooth field, for display and for values at points.
struct SmoothField {
  Field at_vertices;      ///< one row per vertex of the mesh
  CornerWeights weights;  ///< of each patch at its corners: 0 where a wall stands between corner and centroid
};

/// Means at the vertices, weighted by `area` in m^2, the exposed area of each patch. A patch does not contribute to a
/// corner that its center cannot see along the surface: so the two sides of a wall that stands on a patch do not mix,
/// and light does not leak farther than the patch.
SmoothField smooth(const PatchMesh& mesh, const FieldView& patch_values, const Eigen::VectorXd& area,
                   const Occluder& occluder);

/// The smooth field at a point of a patch. Where a wall stands on the patch, from those corners that the point can see.
Eigen::Array<double, 1, Eigen::Dynamic> value_at(const PatchMesh& mesh, const SmoothField& field,
                                                 const Occluder& occluder, PatchIndex patch, const Point& point);

/// A rectangle of pixels [left, right) x [top, bottom).
struct PixelTile {
  int left, top, right, bottom;
};

/// A picture cut into tiles for parallel work.
std::vector<PixelTile> tiles_of(int width, int height);

/// Size and fineness of a picture.
struct RenderOptions {
  int width = 800;
  int height = 800;
  int rays_per_pixel_edge = 3;                               ///< squared per pixel, box filter
  std::function<Spectrum(const Vector&)> surroundings = {};  ///< radiance where nothing is met; none: black
  std::vector<SeenLuminaire> luminaires = {};
};

/// A picture of the solution by ray casting: the radiance in W/(m^2 sr) that reaches the camera, from the smoothed
/// radiance of the patches. Sides without patches are transparent to the camera; where nothing is met the surroundings
/// are seen. \throws InputError when eye and target are one point or the field of view is not between 0 and 180
/// degrees; Canceled.
Image render(const PatchMesh& mesh, const SmoothField& radiance, const Occluder& occluder, const SurfaceOptics& optics,
             const Camera& camera, const Vector& up, const RenderOptions& options = {}, const Observer& observer = {});

/// The share of the hemisphere, weighted by the cosine, in which nothing opaque lies within a distance in meters: the
/// mean over each patch, by so many rays. 1 before an open sky, 0 in a closed room smaller than that.
Eigen::VectorXd ambient_occlusion(const PatchMesh& mesh, const Occluder& occluder, double distance,
                                  std::uint32_t rays = 256);

/// A picture without light, of faces as bright as their reflectance times that share at each point. The occluder must
/// have all faces.
Image ambient_image(const Scene& scene, const Occluder& occluder, const Lens& lens, int width, int height,
                    double distance);

}  // namespace patchlight
