// The true error and the cost of runs with a requested accuracy, against a far finer solution.
// usage: benchmark_accuracy REFERENCE_PATCHES ACCURACIES MODEL...
// ACCURACIES are percentages, e.g. 3,1,0.3.
#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "base/parallel.h"
#include "support/finer_reference.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace patchlight;
using namespace patchlight::test;

// At least this number of uniform patches, then up to three times as many where they reduce the error most.
Simulation finest(const Scene& scene, std::size_t patches) {
  const double most = 3 * static_cast<double>(patches);
  Request request;
  request.mesh.sides = Sides::front;
  request.assembly.samples = 32;
  request.assembly.seed = 77;
  request.mesh.patches = patches;
  request.accuracy.seconds = 1e9;
  request.resources.memory = 8 * most * most;
  return simulate(scene, request);
}

// A reference with fewer times as many patches has an error of its own that counts.
constexpr PatchIndex least_times_finer = 4;

void print(const std::string& name, double asked, const FinerReference& reference, const Scene& scene) {
  const double begin = cpu_seconds();
  Request request;
  request.mesh.sides = Sides::front;
  request.accuracy.relative_error = asked;
  try {
    const Simulation simulation = simulate(scene, request);
    const double cost = cpu_seconds() - begin;
    const AccuracyStep& step = simulation.accuracy.back();
    if (least_times_finer * simulation.mesh.size() > reference.mesh.size()) {
      std::printf("| %s | %g %% | - | %.2f %% | - | - | %u, %d | %.2f |\n", name.c_str(), 100 * asked, 100 * step.total,
                  step.patches, step.samples, cost);
      std::fflush(stdout);
      return;
    }
    const TrueError error = error_against(reference, simulation);
    const Field bar = simulation.error_bars->total();
    std::printf("| %s | %g %% | %.2f %% | %.2f %% | %.0f %% | %.1f | %u, %d | %.2f |\n", name.c_str(), 100 * asked,
                100 * error.relative, 100 * step.total, 100 * covered(error.of_patches, bar),
                median(bar) / median(error.of_patches), step.patches, step.samples, cost);
  } catch (const MemoryError& refusal) {
    std::printf("| %s | %g %% | %s |\n", name.c_str(), 100 * asked, refusal.what());
  }
  std::fflush(stdout);
}

std::vector<double> accuracies(const std::string& percentages) {
  std::istringstream text(percentages);
  std::vector<double> all;
  for (std::string one; std::getline(text, one, ',');) all.push_back(std::stod(one) / 100);
  return all;
}

}  // namespace

int main(int count, char** values) {
  if (count < 4) {
    std::fputs("usage: benchmark_accuracy REFERENCE_PATCHES ACCURACIES MODEL...\n", stderr);
    return 1;
  }
  const auto patches = static_cast<std::size_t>(std::strtoul(values[1], nullptr, 10));
  std::puts(
      "| room | requested | true | stated | patches within their bar | median bar / median error | patches, samples | "
      "CPU s |\n|---|---|---|---|---|---|---|---|");
  for (int k = 3; k < count; ++k) {
    const Scene scene = read_scene(values[k]);
    const Simulation finer = finest(scene, patches);
    const FinerReference reference = reference_of(finer);
    for (const double asked : accuracies(values[2]))
      print(std::filesystem::path(values[k]).stem().string(), asked, reference, scene);
    std::fprintf(stderr, "%s: reference of %u patches\n", values[k], finer.mesh.size());
  }
  return 0;
}
