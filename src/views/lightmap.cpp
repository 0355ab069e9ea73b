#include "render/lightmap.h"

#include "patchlight/base/error.h"
#include "patchlight/views/picture.h"

#include "base/sampling.h"
#include "lighting/lighting.h"
#include "lighting/sky_openings.h"
#include "pipeline/world.h"
#include "plan/memory.h"
#include "plan/planned_scene.h"
#include "views/solved_light.h"

#include <string>

namespace patchlight {
namespace {

// What patches send out that does not follow from the irradiance on their fronts: E + t H_behind, W/m^2.
Field sent_besides(const Simulation& simulation) {
  const Scattering& scattering = simulation.problem.scattering;
  Field sent = simulation.problem.exitance;
  if (scattering.other_side.empty()) return sent;
  for (Eigen::Index patch = 0; patch < sent.rows(); ++patch) {
    const PatchIndex other = scattering.other_side[static_cast<std::size_t>(patch)];
    sent.row(patch) += scattering.transmittance.row(patch) * simulation.solution.irradiance.row(other);
  }
  return sent;
}

// Three fields in single precision, once more while they are written, and what a texel has besides.
void require_memory_of(const PackedCharts& charts, const Simulation& simulation) {
  const auto bands = static_cast<double>(simulation.problem.exitance.cols());
  const double bytes = static_cast<double>(charts.width) * charts.height * (2 * 12 * bands + 8);
  const double usable = usable_memory(simulation.plan.resources);
  if (bytes <= usable) return;
  throw InputError("lightmap", "found that " + std::to_string(charts.width) + " x " + std::to_string(charts.height) +
                                   " texels take " + gigabytes(bytes) + ", and " + gigabytes(usable) +
                                   " may be taken; expected larger texels or fewer bands");
}

}  // namespace

Lightmap bake_lightmap(const Simulation& simulation, const LightmapOptions& options, const Observer& observer) {
  PackedCharts charts = packed_charts(charts_of(simulation.world->scene(), simulation.mesh), options.texel);
  require_memory_of(charts, simulation);
  BakeOptions baking{.seed = hash({simulation.plan.assembly.seed})};
  if (!simulates(simulation.plan, Effect::interreflection)) baking.hemisphere.most_bounces = 0;
  return bake(solved_light(simulation), sent_besides(simulation), std::move(charts), baking, observer);
}

}  // namespace patchlight
