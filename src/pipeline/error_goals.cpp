#include "pipeline/error_goals.h"

#include "accuracy/errors.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// How an accuracy is shared out, in quadrature, beside a little for the solver.
constexpr double share_of_mesh = 0.7;
constexpr double share_of_form_factors = 0.6;

int next_samples(const Plan& plan, double factor) {
  const int samples = samples_of(plan.assembly);
  const double needed = samples * factor * factor;
  int next = samples;
  while (next < needed && next < most_samples(plan)) next = std::min(2 * next, most_samples(plan));
  return std::max(samples, next);
}

// What samples err may be, when all else is as it is: mesh, solver, and what of the form factors' error has nothing
// to do with their samples.
double allowed_noise(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  const double noise = solved.noise_bar;
  const double beside = std::sqrt(std::max(0.0, step.form_factor * step.form_factor - noise * noise));
  return allowed(accuracy, share_of_form_factors, std::hypot(step.mesh, step.solver, beside));
}

}  // namespace

double allowed(double accuracy, double share, double others) {
  return std::max(share * accuracy, std::sqrt(std::max(0.0, accuracy * accuracy - others * others)));
}

int most_samples(const Plan& plan) { return plan.assembly.storage == Storage::rays ? 4096 : 256; }

double patches_for(double patches, double factor) { return patches * std::pow(std::max(1.0, factor), 2 / mesh_order); }

double mesh_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  const double lights = solved.light_bar;
  const double beside = std::sqrt(std::max(0.0, step.form_factor * step.form_factor - lights * lights));
  return error_margin * std::hypot(step.mesh, lights) /
         allowed(accuracy, share_of_mesh, std::hypot(beside, step.solver));
}

double noise_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  return error_margin * solved.noise_bar / allowed_noise(solved, step, accuracy);
}

int samples_for(const SolvedMesh& solved, const AccuracyStep& step, double accuracy, const Plan& plan) {
  constexpr double far_off = 1.5;
  const int samples = samples_of(plan.assembly);
  if (plan.assembly.storage != solved.simulation.plan.assembly.storage) return samples;
  if (mesh_factor(solved, step, accuracy) > far_off) return samples;
  const double patches = patches_for(step.patches, mesh_factor(solved, step, accuracy));
  const double factor = noise_factor(solved, step, accuracy) * std::sqrt(step.patches / patches);
  return factor > error_margin ? next_samples(plan, factor) : samples;
}

}  // namespace patchlight
