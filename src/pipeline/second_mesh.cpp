#include "pipeline/second_mesh.h"

#include "base/rounded.h"
#include "mesh/nested_mesh.h"
#include "pipeline/error_goals.h"
#include "pipeline/local_cuts.h"
#include "plan/memory.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// An error of so much is left as it is where no accuracy was asked for.
constexpr double usual_error = 0.02;

// What a second mesh is made for, as what it leaves is an estimate. Rays of rows cost less than those to sun and sky,
// which are more.
constexpr LocalGoal usual{
    .error = usual_error / error_margin, .new_patches = 0.25, .more_to_lights = 0.5, .more_of_rows = 1.5};

// It pays where it leaves less than this share of the error.
constexpr double worthwhile = 0.7;

// With more patches a second mesh takes minutes: who wants it asks for an accuracy.
constexpr PatchIndex most_patches = 100'000;

std::string errors_of_first(const AccuracyStep& errors) {
  return "the first mesh, of " + std::to_string(errors.patches) + " patches, errs by " + percent(errors.total, 2) +
         " %: ";
}

Diagnostics notes_on_cuts(const MeshToSolve& next, const AccuracyStep& errors) {
  const auto is_doubled = [&](std::size_t i) {
    const auto any = [i](const std::vector<std::uint8_t>& doublings) { return !doublings.empty() && doublings[i] > 0; };
    return any(next.known.more_rays.to_lights) || any(next.known.more_rays.of_rows);
  };
  const std::size_t cut = errors.patches - number_kept(next.known.place);
  std::size_t doubled = 0;
  for (std::size_t i = 0; i < next.known.place.size(); ++i) doubled += is_doubled(i) ? 1 : 0;
  const std::string cuts = cut > 0 ? std::to_string(cut) + " of them are cut" : "";
  const std::string rays = doubled > 0 ? std::to_string(doubled) + " patches take more rays" : "";
  return {{DiagnosticCode::second_mesh, errors_of_first(errors) + "on a second one " + cuts +
                                            (cuts.empty() || rays.empty() ? "" : ", and ") + rays +
                                            "; accuracy.local_cuts=false stays with the first"}};
}

Diagnostics notes_on_memory(const LocalCuts& cuts, const AccuracyStep& errors, const Plan& plan) {
  const std::size_t patches = cuts.mesh.mesh.patches.size();
  const double bytes = memory_of_next_mesh(patches, times_the_rays(cuts), plan);
  return {{DiagnosticCode::second_mesh, errors_of_first(errors) + "a second one, of " + std::to_string(patches) +
                                            " patches, would err less and is not made, as it " +
                                            memory_refused(bytes, plan.resources)}};
}

}  // namespace

bool makes_second_mesh(const Plan& plan, PatchIndex patches) {
  const AccuracyOptions& accuracy = plan.accuracy;
  return accuracy.local_cuts && accuracy.error_bars && !refines(accuracy) && plan.assembly.storage == Storage::rays &&
         patches <= most_patches;
}

bool makes_second_mesh(const Run& run, PatchIndex patches) {
  return makes_second_mesh(run.plan, patches) && !run.with.mesh && !run.with.ray_exchange && !run.with.solve;
}

bool cuts_locally(const Run& run, PatchIndex patches) {
  return refines(run.plan.accuracy) || makes_second_mesh(run, patches);
}

SecondMesh second_mesh(const Run& run, SolvedMesh& solved, const AccuracyStep& errors) {
  if (!makes_second_mesh(run, errors.patches) || !(errors.total > usual_error)) return {};
  LocalCuts cuts = local_cuts(solved, errors, usual);
  const bool pays = cuts.gain > (1 - worthwhile * worthwhile) * errors.total * errors.total;
  if (!pays) return {};
  const Plan& plan = solved.simulation.plan;
  if (!fits_as_next_mesh(cuts.mesh.mesh.patches.size(), times_the_rays(cuts), plan))
    return {std::nullopt, notes_on_memory(cuts, errors, plan)};
  MeshToSolve mesh = mesh_with(std::move(cuts), solved);
  Diagnostics notes = notes_on_cuts(mesh, errors);
  return {std::move(mesh), std::move(notes)};
}

Plan with_note_on_second_mesh(Plan plan, PatchIndex patches) {
  if (!makes_second_mesh(plan, patches) || fits_as_next_mesh(patches, 1, plan)) return plan;
  plan.notes.push_back({DiagnosticCode::second_mesh,
                        "a second mesh, which is made where the first errs by more than " + percent(usual_error) +
                            " %, does not fit into the memory beside the first: it " +
                            memory_refused(memory_of_next_mesh(patches, 1, plan), plan.resources)});
  return plan;
}

}  // namespace patchlight
