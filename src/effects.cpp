#include "effects.h"

#include "patchlight/base/error.h"
#include "patchlight/light/photometry.h"

#include "base/parallel.h"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace patchlight {
namespace {

// Every spectrum of a luminaire, sun, sky or material changed by change(spectrum); empty ones stay empty.
template <typename Change>
void change_light(Luminaire& luminaire, const Change& change) {
  std::visit(
      [&](auto& light) {
        using Light = std::decay_t<decltype(light)>;
        if constexpr (std::is_same_v<Light, WebLight>) {
          light.watts_per_lumen = change(light.watts_per_lumen);
        } else if constexpr (std::is_same_v<Light, SphericalLamp>) {
          light.exitance = change(light.exitance);
        } else {
          light.intensity = change(light.intensity);
        }
      },
      luminaire.light);
}

template <typename Change>
Scene with_spectra(Scene scene, const Change& change) {
  const auto apply = [&](Spectrum& spectrum) {
    if (spectrum.size() > 0) spectrum = change(spectrum);
  };
  for (Material& material : scene.materials) {
    for (Spectrum* s : {&material.reflectance, &material.transmittance, &material.exitance}) apply(*s);
  }
  for (Luminaire& luminaire : scene.luminaires) change_light(luminaire, change);
  if (scene.sun) apply(scene.sun->normal_irradiance);
  if (scene.sky) {
    for (Spectrum* s : {&scene.sky->horizontal_irradiance, &scene.sky->zenith_radiance, &scene.sky->ground_radiance})
      apply(*s);
  }
  return scene;
}

// The same luminance without colour.
Spectrum without_colour(const Spectrum& spectrum) {
  return Spectrum::Constant(spectrum.size(), luminance(spectrum) / luminous_efficacy);
}

bool is_skipped_by_force(const Plan& plan, Effect effect) {
  return std::any_of(plan.decisions.begin(), plan.decisions.end(), [effect](const Decision& decision) {
    return decision.effect == effect && decision.forced && !decision.simulate;
  });
}

bool is_forced(const Plan& plan, Effect effect) {
  return std::any_of(plan.decisions.begin(), plan.decisions.end(), [effect](const Decision& decision) {
    return decision.effect == effect && decision.forced && decision.simulate;
  });
}

// The scene with the lights that are not left out, and without colour when that is skipped by force.
template <typename LeftOut>
Scene with_light(Scene scene, const Plan& plan, const LeftOut& left_out) {
  if (left_out(Effect::luminaires)) scene.luminaires.clear();
  if (left_out(Effect::sun)) scene.sun.reset();
  if (left_out(Effect::sky)) scene.sky.reset();
  return is_skipped_by_force(plan, Effect::colour) ? with_spectra(std::move(scene), without_colour) : scene;
}

// Rows of lamps that are asked for at once.
constexpr PatchIndex rows_at_once = 64;

// Ranges of patches that emit, of so many at most.
std::vector<PatchRange> lamps_of(const FieldView& exitance) {
  std::vector<PatchRange> lamps;
  for (Eigen::Index row = 0; row < exitance.rows(); ++row) {
    if (!(exitance.row(row) > 0).any()) continue;
    const auto i = static_cast<PatchIndex>(row);
    if (!lamps.empty() && lamps.back().end == i && i - lamps.back().begin < rows_at_once) {
      ++lamps.back().end;
    } else {
      lamps.push_back({i, i + 1});
    }
  }
  return lamps;
}

// H = F E + H_direct; B = E + rho o H.
Solution light_of_lamps(const RowTransport& transport, const RadiosityProblem& problem, const Observer& observer) {
  const double start = wall_seconds();
  Field H = irradiance_by_lamps(transport, problem.exitance, Stage::solve, observer);
  if (problem.direct_irradiance.size() > 0) H += problem.direct_irradiance;
  const auto rows = (problem.exitance > 0).rowwise().any().count();
  Solution solution;
  solution.radiosity = radiosity_from(problem, H);
  solution.direct_irradiance = H;
  solution.irradiance = H;
  solution.error = Field::Zero(H.rows(), H.cols());
  solution.patch_bound = 0;
  solution.converged = true;
  solution.history = {{.seconds = wall_seconds() - start,
                       .work = static_cast<double>(rows) / static_cast<double>(problem.exitance.rows())}};
  const Progress last{.stage = Stage::solve, .fraction = 1, .iteration = &solution.history[0], .irradiance = &H};
  if (observer && !observer(last)) throw Cancelled();
  return solution;
}

}  // namespace

Occluder::Blockers blockers_of(const Plan& plan) {
  if (is_skipped_by_force(plan, Effect::occlusion)) return Occluder::Blockers::none;
  return is_forced(plan, Effect::occlusion) ? Occluder::Blockers::all : Occluder::Blockers::inside_hull;
}

Scene scene_for_sensors(Scene scene, const Plan& plan) {
  return with_light(std::move(scene), plan, [&](Effect effect) { return is_skipped_by_force(plan, effect); });
}

Scene scene_as_planned(Scene scene, const Plan& plan) {
  return with_light(std::move(scene), plan, [&](Effect effect) { return !simulates(plan, effect); });
}

DirectIrradiance direct_irradiance_as_planned(const Setting& setting, const Plan& plan, const PatchMesh& mesh) {
  const auto trace = [&](const Scene& scene) {
    return direct_irradiance(lighting_of(scene, *setting.tracing), mesh, {.seed = plan.seed}, setting.observer);
  };
  if (plan.lamp_colour.size() == 0) return trace(setting.scene);
  // All light has the lamps' colour, and nothing changes it on the way: one band tells all.
  Eigen::Index brightest = 0;
  plan.lamp_colour.maxCoeff(&brightest);
  const auto band = [brightest](const Spectrum& spectrum) { return Spectrum::Constant(1, spectrum[brightest]); };
  const DirectIrradiance found = trace(with_spectra(setting.scene, band));
  const auto in_all = [&](const Field& field) { return Field(field.matrix() * plan.lamp_colour.matrix()); };
  return {in_all(found.irradiance), in_all(found.standard_error)};
}

Field irradiance_by_lamps(const RowTransport& transport, const FieldView& exitance, Stage stage,
                          const Observer& observer) {
  Field H = Field::Zero(exitance.rows(), exitance.cols());
  for (const PatchRange& lamp : lamps_of(exitance)) {
    if (observer && !observer({.stage = stage})) throw Cancelled();
    const Eigen::Index count = lamp.end - lamp.begin;
    H += transport.shoot(lamp, exitance.middleRows(lamp.begin, count));
  }
  return H;
}

SolveWith solver_as_planned(SolveWith solve, const Plan& plan) {
  if (simulates(plan, Effect::interreflection)) return solve;
  return [](const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions&,
            const Observer& observer) { return light_of_lamps(transport, problem, observer); };
}

}  // namespace patchlight
