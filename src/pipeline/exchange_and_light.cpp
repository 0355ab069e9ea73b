#include "pipeline/exchange_and_light.h"

#include "patchlight/base/error.h"

#include "base/sampling.h"
#include "base/vectors.h"
#include "lighting/light_source.h"
#include "plan/goal.h"
#include "plan/planned_scene.h"
#include "transport/ray_rows.h"
#include "transport/row_tracer.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// Sums over all bands, per patch.
Eigen::VectorXd summed_over_bands(const Field& field) { return field.rowwise().sum().matrix(); }

// The factors of emitters, the patches of a side each, by the clear faces of the run.
EmitterFactors factors_of_emitters(std::span<const PatchRange> emitters, const Run& run, const Plan& plan,
                                   const PatchMesh& mesh) {
  std::vector<EmitterSide> sides;
  for (const PatchRange& emitter : emitters) sides.push_back({mesh.polygon[emitter.begin], mesh.side[emitter.begin]});
  return emitter_factors(run.scene, mesh, run.world->between_patches(), sides,
                         {.rays = plan.assembly.rays, .seed = plan.assembly.seed}, run.observer);
}

// The factors of the separate emitters, without rows.
RayExchange traced_emitters(const Run& run, const Plan& plan, const PatchMesh& mesh, const RadiosityProblem& problem) {
  RayExchange found;
  for (const EmitterSide& emitter : select_emitters(run.scene, mesh, problem, max_emitter_pieces(run.world->tracing())))
    found.emitters.push_back(mesh.patches_on(emitter.polygon, emitter.side));
  found.emitter_factors = factors_of_emitters(found.emitters, run, plan, mesh);
  return found;
}

// Emitters that are bright now, but were neither separate nor bright when the rows were traced: rays would miss most of
// their light.
std::vector<PatchRange> new_emitters(const Run& run, const PatchMesh& mesh, const RadiosityProblem& problem,
                                     const RayExchange& known) {
  std::vector<PatchRange> emitters;
  std::size_t pieces = 0;
  for (const EmitterSide& emitter :
       select_emitters(run.scene, mesh, problem, std::numeric_limits<std::size_t>::max())) {
    const PatchRange patches = mesh.patches_on(emitter.polygon, emitter.side);
    const auto is_same = [&](const PatchRange& one) { return one.begin == patches.begin; };
    const bool is_apart = std::any_of(known.emitters.begin(), known.emitters.end(), is_same);
    if (is_apart || known.rows.directed[patches.begin] != 0) continue;
    emitters.push_back(patches);
    pieces += piece_count(run.scene, emitter);
  }
  if (pieces > 64)
    throw InputError("given.ray_rows", "too many lamps were dark when these form factors were computed: " +
                                           std::to_string(emitters.size()) +
                                           "\nhint: compute them again with these lamps lit");
  return emitters;
}

// Another emitter, whose factors are columns of their own.
EmitterValues joined(const EmitterValues& some, const EmitterValues& more) {
  EmitterValues all(more.rows(), some.cols() + more.cols());
  all << some, more;
  return all;
}

// With the factors of emitters that are bright, and were dark when the rows were traced; of all emitters where there
// are clear faces or mirrors, which may have other colors now.
RayExchange with_emitters(RayExchange known, const Run& run, const Plan& plan, const PatchMesh& mesh,
                          const RadiosityProblem& problem) {
  const std::vector<PatchRange> emitters = new_emitters(run, mesh, problem, known);
  known.emitters.insert(known.emitters.end(), emitters.begin(), emitters.end());
  EmitterFactors& factors = known.emitter_factors;
  if (run.world->tracing().has_specular_surfaces() || !known.specular_kinds.empty()) {
    factors = factors_of_emitters(known.emitters, run, plan, mesh);
  } else if (!emitters.empty()) {
    const EmitterFactors more = factors_of_emitters(emitters, run, plan, mesh);
    for (std::size_t half = 0; half < 2; ++half) factors.halves[half] = joined(factors.halves[half], more.halves[half]);
    factors.standard_error = joined(factors.standard_error, more.standard_error);
  }
  return known;
}

// The irradiance by separate emitters over mirrors and clear faces, which their factors do not include; empty if
// reflections are not followed.
DirectIrradiance emitters_in_mirrors(const Run& run, const LightingOptions& options, const PatchMesh& mesh,
                                     const std::vector<PatchRange>& emitters) {
  if (emitters.empty() || run.world->tracing().reflections() == Reflections::kept) return {};
  const Lighting& lighting = run.world->lighting_by_polygons();
  if (!lighting.mirrors) return {};
  std::vector<EmitterFace> faces;
  for (const PatchRange& patches : emitters) {
    const auto of_emitter = emitter_faces(run.scene, mesh.polygon[patches.begin], mesh.side[patches.begin]);
    faces.insert(faces.end(), of_emitter.begin(), of_emitter.end());
  }
  return direct_irradiance({lighting, std::move(faces)}, mesh, options, run.observer);
}

// Half as many rays towards bright patches as over the hemisphere, in packets of both halves. In meshes with many
// patches, most patches that see backs lie inside solids; a few rays detect that as well.
RayOptions rays_as_planned(const Plan& plan, const PatchMesh& mesh) {
  const AssemblyOptions& assembly = plan.assembly;
  return {.rays = assembly.rays,
          .areas = important_areas(mesh, plan.goal.get()),
          .toward_bright = std::max(1, assembly.rays / 64) * 32,
          .lost_share_rays =
              takes_few_rays(plan, mesh.size()) ? std::min(assembly.lost_share_rays, 64) : assembly.lost_share_rays,
          .seed = assembly.seed};
}

// Ray counts shared by all patches grow with the mean number per patch, by powers of two.
int times_for_all(const Known& known) {
  const std::vector<std::uint8_t>& doublings = known.more_rays.of_rows;
  const double mean = doublings.empty() ? 1 : multiples(doublings, static_cast<Eigen::Index>(doublings.size())).mean();
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(mean)));
}

// H = F_lamps E_lamps for factors of one value per patch and emitter.
Field irradiance_by(const EmitterValues& factors, const Field& exitance) {
  return (factors.cast<double>().matrix() * exitance.matrix()).array();
}

// The light of the separate emitters, as means over whole patches.
RayLight light_of(const RayExchange& exchange, LitProblem lit, PatchIndex patches) {
  RayLight light;
  light.lit = std::move(lit);
  const RadiosityProblem& problem = light.lit.problem;
  light.is_apart.assign(patches, 0);
  Field exitance(static_cast<Eigen::Index>(exchange.emitters.size()), problem.exitance.cols());
  for (std::size_t k = 0; k < exchange.emitters.size(); ++k) {
    const auto [begin, end] = exchange.emitters[k];
    exitance.row(static_cast<Eigen::Index>(k)) = problem.exitance.row(begin);
    std::fill(light.is_apart.begin() + begin, light.is_apart.begin() + end, 1);
  }
  const EmitterFactors& factors = exchange.emitter_factors;
  for (std::size_t half = 0; half < 2; ++half) light.by_emitters[half] = irradiance_by(factors.halves[half], exitance);
  light.emitter_standard_error = irradiance_by(factors.standard_error.square(), exitance.square()).sqrt();
  return light;
}

BrightPatches bright_patches_of(const Run& run, const PatchMesh& mesh, const RayLight& light) {
  const Field expected = emitted_in_rows(light) + light.lit.problem.scattering.reflect(direct_of(light));
  return {mesh, summed_over_bands(expected), explicit_emitter_ratio, run.world->between_patches()};
}

// Rows, with rays towards bright patches.
TracedRows traced_rows(const Run& run, const Plan& plan, const PatchMesh& mesh, const RayLight& light,
                       const Known& known) {
  const Occluder& occluder = run.world->between_patches();
  const BrightPatches bright_patches = bright_patches_of(run, mesh, light);
  RayOptions options = rays_as_planned(plan, mesh);
  options.seed = seed_on(known, options.seed);
  options.doublings = known.more_rays.of_rows;
  options.toward_bright *= times_for_all(known);
  if (!run.with.row_blocks) return trace_rows(mesh, occluder, bright_patches, options, run.observer);
  const RowBlocks blocks = run.with.row_blocks(mesh, options, bright_patches.densities());
  return trace_rows(mesh, occluder, bright_patches, options, run.observer, &blocks);
}

// The side of a polygon from which rays went on in another way than they would now; none if there is no such.
std::optional<PolygonIndex> other_kind(const std::vector<std::array<double, 2>>& then,
                                       const std::vector<std::array<double, 2>>& now) {
  for (PolygonIndex p = 0; p < now.size(); ++p) {
    for (std::size_t side = 0; side < 2; ++side) {
      const double before = then.empty() ? 0 : then[p][side];
      // Rays that went on from a face that lets nothing go on now count nothing.
      if (now[p][side] != 0 && now[p][side] != before) return p;
    }
  }
  return std::nullopt;
}

// Colors may differ, but the same polygons have to be specular as when the rays were traced.
void require_same_kinds(const RayExchange& known, const Run& run) {
  const auto now = run.world->between_patches().optics().kinds(run.scene.polygons.size());
  const bool is_as_long = known.specular_kinds.empty() || known.specular_kinds.size() == now.size();
  const std::optional<PolygonIndex> other = is_as_long ? other_kind(known.specular_kinds, now) : 0;
  if (!other) return;
  throw InputError("given.ray_rows",
                   "the glazing or mirrors have changed since these form factors were computed (face " +
                       std::to_string(*other + 1) + " of '" +
                       run.scene.materials[run.scene.polygons[*other].material].name +
                       "'); only colors may change\nhint: compute them again: patchlight form-factors MODEL -o FOLDER");
}

}  // namespace

std::vector<EmitterSide> select_emitters(const Scene& scene, const PatchMesh& mesh, const RadiosityProblem& problem,
                                         std::size_t max_pieces) {
  struct Emitter {
    EmitterSide side;
    double flux = 0;
  };
  const Eigen::VectorXd exitance = summed_over_bands(problem.exitance);
  const double mean = scalar_product(exitance, problem.area) / total(problem.area);
  std::vector<Emitter> emitters;
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    for (const Side side : {Side::front, Side::back}) {
      const auto [begin, end] = mesh.patches_on(polygon, side);
      if (begin == end || !(exitance[begin] > explicit_emitter_ratio * mean)) continue;
      emitters.push_back({{polygon, side}, exitance[begin] * problem.area.segment(begin, end - begin).sum()});
    }
  }
  std::stable_sort(emitters.begin(), emitters.end(), [](const auto& a, const auto& b) { return a.flux > b.flux; });
  std::vector<EmitterSide> selected;
  std::size_t pieces = 0;
  for (const Emitter& emitter : emitters) {
    const std::size_t more = piece_count(scene, emitter.side);
    if (more > max_pieces - pieces) continue;
    pieces += more;
    selected.push_back(emitter.side);
  }
  return selected;
}

std::size_t max_emitter_pieces(const Tracing& tracing) {
  return tracing.reflections() == Reflections::followed && tracing.has_specular_surfaces() ? 64 : 16;
}

Field emitted_in_rows(const RayLight& light) {
  Field exitance = light.lit.problem.exitance;
  for (Eigen::Index i = 0; i < exitance.rows(); ++i)
    if (light.is_apart[static_cast<std::size_t>(i)] != 0) exitance.row(i) = 0;
  return exitance;
}

Field direct_of(const RayLight& light) {
  Field direct = 0.5 * (light.by_emitters[0] + light.by_emitters[1]);
  for (const Field* more : {&light.lit.problem.direct_irradiance, &light.in_mirrors.irradiance})
    if (more->size() > 0) direct += *more;
  return direct;
}

ExchangeAndLight exchange_and_light(const Run& run, const Plan& plan, const PatchMesh& mesh, const Known& known) {
  const Eigen::Map<const Eigen::VectorXd> area(mesh.area.data(), static_cast<Eigen::Index>(mesh.size()));
  LitProblem lit = lit_problem(run, plan, mesh, area, known);
  Plan to_emitters = plan;
  to_emitters.assembly.rays *= times_for_all(known);
  const bool is_known = static_cast<bool>(run.with.ray_exchange);
  RayExchange exchange = is_known ? with_emitters(run.with.ray_exchange(mesh), run, plan, mesh, lit.problem)
                                  : traced_emitters(run, to_emitters, mesh, lit.problem);
  RayLight light = light_of(exchange, std::move(lit), mesh.size());
  // Its error counts with the rows.
  LightingOptions over_mirrors = lighting_options(plan, mesh);
  over_mirrors.seed = seed_on(known, over_mirrors.seed);
  over_mirrors.doublings = known.more_rays.of_rows;
  light.in_mirrors = emitters_in_mirrors(run, over_mirrors, mesh, exchange.emitters);
  if (!is_known) {
    exchange.rows = traced_rows(run, plan, mesh, light, known);
    if (run.world->tracing().has_specular_surfaces())
      exchange.specular_kinds = run.world->between_patches().optics().kinds(run.scene.polygons.size());
    return {std::move(exchange), std::move(light)};
  }
  require_same_kinds(exchange, run);
  // Not stored, because it depends on the materials.
  exchange.rows.lost.clear = clear_shares(mesh, run.world->between_patches());
  const BrightPatches now = bright_patches_of(run, mesh, light);
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    light.is_missed.push_back(now.density(i) > 0 && exchange.rows.directed[i] == 0 ? 1 : 0);
  light.rays_per_patch = static_cast<double>(exchange.rows.rays) / mesh.size();
  return {std::move(exchange), std::move(light)};
}

Field columns_of(const Field& all, const std::vector<Eigen::Index>& bands) {
  return all.size() > 0 ? Field(all(Eigen::all, bands)) : Field(all.rows(), 0);
}

ExchangeAndLight in_colour(const ExchangeAndLight& all, const std::vector<Eigen::Index>& bands, const Run& part,
                           const Plan& plan, const PatchMesh& mesh) {
  // 1. Light straight from emitters, also through clear faces.
  ExchangeAndLight found{all.exchange, {}};
  found.exchange.emitter_factors = factors_of_emitters(all.exchange.emitters, part, plan, mesh);

  // 2. Other light is known of each band.
  const RayLight& light = all.light;
  const Eigen::Map<const Eigen::VectorXd> area(mesh.area.data(), static_cast<Eigen::Index>(mesh.size()));
  LitProblem lit{problem_of(part.scene, mesh, area, plan.sides.emit_from_back, reflections_of(plan)),
                 columns_of(light.lit.direct_standard_error, bands), light.lit.doublings,
                 columns_of(light.lit.unfollowed, bands)};
  lit.problem.direct_irradiance = columns_of(light.lit.problem.direct_irradiance, bands);
  found.light = light_of(found.exchange, std::move(lit), mesh.size());
  found.light.in_mirrors = {columns_of(light.in_mirrors.irradiance, bands),
                            columns_of(light.in_mirrors.standard_error, bands),
                            columns_of(light.in_mirrors.unfollowed, bands)};
  found.light.is_missed = light.is_missed;
  found.light.rays_per_patch = light.rays_per_patch;
  return found;
}

}  // namespace patchlight
