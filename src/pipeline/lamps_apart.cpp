#include "pipeline/lamps_apart.h"

#include "patchlight/base/error.h"

#include "base/vectors.h"
#include "lighting/mirrored_irradiance.h"
#include "pipeline/lit_problem.h"

#include <algorithm>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// Pieces of lamps that every patch is sampled with.
constexpr std::size_t most_pieces = 16;
// More where there are mirrors, in which rays over the hemisphere would find the others by luck.
constexpr std::size_t most_pieces_before_mirrors = 64;
constexpr std::size_t most_new_pieces = 64;

struct Lamp {
  LampSide side;
  double flux = 0;
};

// The sides that emit much, the strongest first.
std::vector<Lamp> bright_sides(const Scene& scene, const PatchMesh& mesh, const RadiosityProblem& problem) {
  const Eigen::VectorXd exitance = summed_over_bands(problem.exitance);
  const double mean = scalar_product(exitance, problem.area) / total(problem.area);
  std::vector<Lamp> lamps;
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    for (const Side side : {Side::front, Side::back}) {
      const PatchRange patches = mesh.patches_on(polygon, side);
      if (patches.begin == patches.end || !(exitance[patches.begin] > bright * mean)) continue;
      const auto count = static_cast<Eigen::Index>(patches.end - patches.begin);
      lamps.push_back({{polygon, side}, exitance[patches.begin] * problem.area.segment(patches.begin, count).sum()});
    }
  }
  std::stable_sort(lamps.begin(), lamps.end(), [](const Lamp& a, const Lamp& b) { return a.flux > b.flux; });
  return lamps;
}

}  // namespace

// As many as the number of pieces allows.
std::vector<LampSide> lamps_apart(const Scene& scene, const PatchMesh& mesh, const RadiosityProblem& problem,
                                  const Tracing& tracing) {
  const bool mirrors = tracing.reflections() == Reflections::followed && tracing.has_specular_faces();
  const std::size_t most = mirrors ? most_pieces_before_mirrors : most_pieces;
  std::vector<LampSide> apart;
  std::size_t pieces = 0;
  for (const Lamp& lamp : bright_sides(scene, mesh, problem)) {
    pieces += piece_count(scene, lamp.side);
    if (pieces > most) break;
    apart.push_back(lamp.side);
  }
  return apart;
}

// The factors of the lamps that are apart, without rows.
RayExchange traced_lamps(const Run& run, const Plan& plan, const PatchMesh& mesh, const RadiosityProblem& problem) {
  const std::vector<LampSide> lamps = lamps_apart(run.scene, mesh, problem, run.world->tracing());
  RayExchange found;
  for (const LampSide& lamp : lamps) found.lamps.push_back(mesh.patches_on(lamp.polygon, lamp.side));
  found.lamp_factors = lamp_factors(run.scene, mesh, run.world->between_patches(), lamps,
                                    {.rays = plan.assembly.rays, .seed = plan.assembly.seed}, run.observer);
  return found;
}

LampFactors factors_of_lamps(const std::vector<PatchRange>& lamps, const Run& run, const Plan& plan,
                             const PatchMesh& mesh) {
  std::vector<LampSide> sides;
  for (const PatchRange& lamp : lamps) sides.push_back({mesh.polygon[lamp.begin], mesh.side[lamp.begin]});
  return lamp_factors(run.scene, mesh, run.world->between_patches(), sides,
                      {.rays = plan.assembly.rays, .seed = plan.assembly.seed}, run.observer);
}

namespace {

// What is bright and neither apart nor was bright when the rows were traced: their rays would miss most of it.
std::vector<LampSide> new_lamps(const Run& run, const PatchMesh& mesh, const RadiosityProblem& problem,
                                const RayExchange& known) {
  std::vector<LampSide> lamps;
  std::size_t pieces = 0;
  for (const Lamp& lamp : bright_sides(run.scene, mesh, problem)) {
    const PatchRange patches = mesh.patches_on(lamp.side.polygon, lamp.side.side);
    const auto is_same = [&](const PatchRange& one) { return one.begin == patches.begin; };
    const bool is_apart = std::any_of(known.lamps.begin(), known.lamps.end(), is_same);
    if (is_apart || known.rows.directed[patches.begin] != 0) continue;
    lamps.push_back(lamp.side);
    pieces += piece_count(run.scene, lamp.side);
  }
  if (pieces > most_new_pieces)
    throw InputError("given.ray_rows",
                     "too many lamps were dark when these form factors were computed: " + std::to_string(lamps.size()) +
                         "\nhint: compute them again with these lamps lit");
  return lamps;
}

// Another lamp, whose factors are columns of their own.
LampValues joined(const LampValues& some, const LampValues& more) {
  LampValues all(more.rows(), some.cols() + more.cols());
  all << some, more;
  return all;
}

}  // namespace

RayExchange with_lamps(RayExchange known, const Run& run, const Plan& plan, const PatchMesh& mesh,
                       const RadiosityProblem& problem) {
  const std::vector<LampSide> lamps = new_lamps(run, mesh, problem, known);
  if (run.world->tracing().has_specular_faces() || !known.specular_kinds.empty()) {
    for (const LampSide& lamp : lamps) known.lamps.push_back(mesh.patches_on(lamp.polygon, lamp.side));
    known.lamp_factors = factors_of_lamps(known.lamps, run, plan, mesh);
    return known;
  }
  if (lamps.empty()) return known;
  const LampFactors more = lamp_factors(run.scene, mesh, run.world->between_patches(), lamps,
                                        {.rays = plan.assembly.rays, .seed = plan.assembly.seed}, run.observer);
  LampFactors& factors = known.lamp_factors;
  for (std::size_t half = 0; half < 2; ++half) factors.halves[half] = joined(factors.halves[half], more.halves[half]);
  factors.standard_error = joined(factors.standard_error, more.standard_error);
  for (const LampSide& lamp : lamps) known.lamps.push_back(mesh.patches_on(lamp.polygon, lamp.side));
  return known;
}

// What lamps that are apart send over mirrors, which their factors do not have.
DirectIrradiance lamps_in_mirrors(const Run& run, const LightingOptions& options, const PatchMesh& mesh,
                                  const std::vector<PatchRange>& lamps) {
  if (lamps.empty() || run.world->tracing().reflections() == Reflections::kept) return {};
  Scene scene = run.scene;
  scene.luminaires.clear();
  scene.sun.reset();
  scene.sky.reset();
  const Lighting lighting = lighting_of(scene, run.world->tracing());
  if (!lighting.mirrors) return {};
  std::vector<LampFace> faces;
  for (const PatchRange& patches : lamps) {
    const auto of_lamp = lamp_faces(scene, mesh.polygon[patches.begin], mesh.side[patches.begin]);
    faces.insert(faces.end(), of_lamp.begin(), of_lamp.end());
  }
  return mirrored_irradiance(lighting, faces, mesh, options, run.observer);
}

}  // namespace patchlight
