#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "mesh/interpolate.h"
#include "mesh/patch_lookup.h"
#include "visibility/occluder.h"

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace patchlight {

/// A sphere that emits evenly and hides what is behind it.
struct SeenSphere {
  Point centre;
  double radius = 0;  ///< metres
  Spectrum radiance;  ///< W/(m^2 sr)
};

/// A patch that a ray sees, behind clear faces or not; none where it meets nothing.
struct SeenPatch {
  std::size_t ray = 0;
  std::optional<PatchIndex> patch;
  Point point = Point::Zero();  ///< on the patch
  Vector direction;
  double share = 1;                    ///< of its light that gets through what is before it
  bool outlook = false;                ///< behind a clear face, or nothing is met
  double distance = 0;                 ///< along the way from the ray's origin, metres
  const SeenSphere* sphere = nullptr;  ///< that is seen in place of a patch
};

/// The luminaires that are spheres.
std::vector<SeenSphere> spheres_of(const std::vector<Luminaire>& luminaires);

/// What rays see: the first patch that each meets and, as long as that is clear or a mirror, what is behind it and in
/// it. Rays pass sides without patches: they go on from there. They end on spheres.
std::vector<SeenPatch> seen_by(const Occluder& occluder, const PatchLookup& lookup, const std::vector<Ray>& rays,
                               const std::vector<SeenSphere>& spheres = {});

/// Patch values as a smooth field, for display and for values at points.
struct SmoothField {
  Field at_vertices;  ///< one row per vertex of the mesh
  CornerWeights
      weights;  ///< of each patch at its corners: 0 where a wall stands between the corner and the patch's centre
};

/// Means at the vertices, weighted by `area` in m^2, the exposed area of each patch. A patch does not contribute to a
/// corner that its centre cannot see along the surface: so the two sides of a wall that stands on a patch do not mix,
/// and light does not leak farther than the patch.
SmoothField smooth(const PatchMesh& mesh, const FieldView& patch_values, const Eigen::VectorXd& area,
                   const Occluder& occluder);

/// The smooth field at a point of a patch. Where a wall stands on the patch, from those corners that the point can see.
Eigen::Array<double, 1, Eigen::Dynamic> value_at(const PatchMesh& mesh, const SmoothField& field,
                                                 const Occluder& occluder, PatchIndex patch, const Point& point);

/// Size and fineness of a picture.
struct RenderOptions {
  int width = 800;
  int height = 800;
  int rays_per_pixel_edge = 3;                               ///< squared per pixel, box filter
  std::function<Spectrum(const Vector&)> surroundings = {};  ///< radiance where nothing is met; none: black
  std::vector<SeenSphere> spheres = {};
};

/// A picture of the solution by ray casting: the radiance in W/(m^2 sr) that reaches the camera, from the smoothed
/// radiance of the patches. Sides without patches are transparent to the camera; where nothing is met the surroundings
/// are seen. \throws InputError when eye and target are one point or the field of view is not between 0 and 180
/// degrees; Cancelled.
Image render(const PatchMesh& mesh, const SmoothField& radiance, const Occluder& occluder, const Camera& camera,
             const Vector& up, const RenderOptions& options = {}, const Observer& observer = {});

/// A view that shows most of the kept sides. Where an upright side of the scene's bounds is open, from before it
/// through the opening; otherwise from a corner of the bounds, inside, at eye height, to the opposite one. Of several
/// such views that from which the most different polygons are seen over the widest part of the picture.
Camera default_camera(const Scene& scene, const KeptSides& sides, const Occluder& occluder);

/// True when most of an upright side of the bounds is a hole through which one sees into the depth, onto kept sides.
bool has_open_side(const Scene& scene, const KeptSides& sides, const Occluder& occluder);

}  // namespace patchlight
