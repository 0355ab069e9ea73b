#include "pipeline/first_mesh.h"

#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"

namespace patchlight {

NestedMesh first_mesh(const Scene& scene, const Plan& plan) {
  if (plan.accuracy.error_bars) return nest(tessellate(scene, plan.sides, 2 * plan.max_edge));
  NestedMesh mesh;
  mesh.patches = tessellate(scene, plan.sides, plan.max_edge);
  return mesh;
}

}  // namespace patchlight
