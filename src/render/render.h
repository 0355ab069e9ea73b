#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "render/seen.h"
#include "render/smooth.h"
#include "visibility/occluder.h"

#include <functional>
#include <vector>

namespace patchlight {

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
