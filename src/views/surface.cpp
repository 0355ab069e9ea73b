#include "patchlight/views/views.h"

#include "pipeline/world.h"
#include "render/ambient_occlusion.h"
#include "render/render.h"
#include "visibility/occluder.h"

#include <numbers>

namespace patchlight {

SolvedSurface surface_of(const Simulation& simulation, const std::optional<double>& ambient_distance) {
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;  // L = B / pi
  const Occluder& occluder = simulation.world->all_faces();
  const PatchMesh& mesh = simulation.mesh;
  const Eigen::VectorXd& area = simulation.problem.area;
  SolvedSurface surface{simulation.world->scene(), simulation, smooth(mesh, radiance, area, occluder).at_vertices};
  if (ambient_distance) {
    surface.ambient_occlusion = ambient_occlusion(mesh, occluder, *ambient_distance);
    surface.ambient_occlusion_at_vertices =
        smooth(mesh, Field(surface.ambient_occlusion.array()), area, occluder).at_vertices.col(0).matrix();
  }
  return surface;
}

}  // namespace patchlight
