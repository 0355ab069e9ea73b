#include "pipeline/light_colours.h"

#include "accuracy/interest.h"
#include "pipeline/joined_colours.h"
#include "pipeline/lit_problem.h"
#include "pipeline/mesh_transport.h"
#include "pipeline/second_mesh.h"
#include "pipeline/solved.h"
#include "pipeline/with_error_bars.h"
#include "plan/planned_scene.h"

#include <algorithm>
#include <set>
#include <utility>

namespace patchlight {
namespace {

// The spectra of all that is clear or a mirror.
std::vector<Spectrum> specular_spectra(const Scene& scene, Reflections reflections) {
  std::set<MaterialIndex> clear, mirrors;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const bool is_clear = is_opening(scene, p);
    for (const Side side : {Side::front, Side::back}) {
      const MaterialIndex material = material_on(scene.polygons[p], side);
      if (is_clear) clear.insert(material);
      if (!is_clear && is_mirror(scene, p, side) && reflections == Reflections::followed) mirrors.insert(material);
    }
  }
  std::vector<Spectrum> spectra;
  for (const MaterialIndex m : clear) spectra.push_back(scene.materials[m].transmittance);
  for (const MaterialIndex m : mirrors) spectra.push_back(scene.materials[m].specular_reflectance);
  return spectra;
}

// Bands in which all spectra have the same values, in the order of their first.
std::vector<std::vector<Eigen::Index>> alike_bands(const std::vector<Spectrum>& spectra, Eigen::Index bands) {
  std::vector<std::vector<Eigen::Index>> groups;
  for (Eigen::Index band = 0; band < bands; ++band) {
    const auto is_alike = [&](const std::vector<Eigen::Index>& group) {
      return std::all_of(spectra.begin(), spectra.end(),
                         [&](const Spectrum& s) { return s.size() == 0 || s[band] == s[group.front()]; });
    };
    const auto found = std::find_if(groups.begin(), groups.end(), is_alike);
    if (found == groups.end()) {
      groups.push_back({band});
    } else {
      found->push_back(band);
    }
  }
  return groups;
}

// What a plan says of single bands.
Plan in_bands(Plan plan, const std::vector<Eigen::Index>& bands) {
  if (plan.lamp_colour.size() == 0) return plan;
  Spectrum chosen(static_cast<Eigen::Index>(bands.size()));
  for (Eigen::Index k = 0; k < chosen.size(); ++k) chosen[k] = plan.lamp_colour[bands[static_cast<std::size_t>(k)]];
  plan.lamp_colour = (chosen > 0).any() ? chosen : Spectrum();
  return plan;
}

}  // namespace

std::vector<LightColour> light_colours(const Run& run) {
  if (run.plan.assembly.storage != Storage::rays || !run.tracing->has_specular_faces()) return {};
  const Reflections reflections = run.tracing->reflections();
  const auto groups = alike_bands(specular_spectra(run.scene, reflections), number_of_bands(run.scene));
  if (groups.size() < 2) return {};
  std::vector<LightColour> colours;
  for (const std::vector<Eigen::Index>& bands : groups) {
    Scene scene = in_bands(run.scene, bands);
    auto tracing = std::make_shared<const Tracing>(scene, run.tracing->coverings(), blockers_of(run.plan), reflections);
    colours.push_back({bands, std::move(scene), std::move(tracing)});
  }
  return colours;
}

SolvedMesh solved_in_colours(const Run& run, const std::vector<LightColour>& colours, const MeshToSolve& meshed,
                             StageClock& clock) {
  const ExchangeAndLight all_bands = exchange_and_light(run, meshed.plan, meshed.mesh.patches, meshed.known);
  clock.finish(Stage::form_factors);
  std::vector<SolvedMesh> parts;
  for (const LightColour& colour : colours) {
    const Plan plan = in_bands(run.plan, colour.bands);
    const Run part{colour.scene, run.request, plan, run.notes, colour.tracing, run.with, run.observer, true};
    const MeshToSolve in_part{meshed.mesh, in_bands(meshed.plan, colour.bands), {}};
    const PatchMesh& mesh = in_part.mesh.patches;
    RawTransport raw =
        raw_transport(ray_light(part, mesh, in_colour(all_bands, colour.bands, part, in_part.plan, mesh)));
    MeshTransport transport = closed_transport(part, in_part.plan, in_part.mesh, std::move(raw));
    LitProblem problem = transport.light->lit;
    clock.finish(Stage::closure);
    Simulation simulation = solved(part, in_part, transport, std::move(problem));
    clock.finish(Stage::solve);
    parts.push_back(with_error_bars(part, {std::move(simulation), in_part.mesh}, std::move(transport)));
    clock.finish(Stage::error_bars);
  }
  SolvedMesh all = joined(run, colours, meshed, std::move(parts));
  const LitProblem& lit = all_bands.light.lit;
  if (cuts_locally(run, meshed.mesh.patches.size()) && lit.direct_standard_error.size() > 0)
    all.light = {lit.problem.direct_irradiance, lit.direct_standard_error};
  if (all.interest.size() > 0) require_reflecting(run.scene, all.simulation.problem, all.interest);
  return all;
}

}  // namespace patchlight
