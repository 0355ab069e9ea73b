// What an accuracy that is asked for gives and costs, against a far finer solution, and what the cheapest setting costs
// that a sweep of uniform meshes finds.
// usage: benchmark_accuracy [--no-sweep] REFERENCE_PATCHES ACCURACIES MODEL...
// ACCURACIES are percentages, as 3,1,0.3. Without the sweep the last columns stay empty.
#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "base/parallel.h"
#include "support/finer_reference.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace patchlight;
using namespace patchlight::test;

constexpr std::size_t uniform_meshes[] = {150, 300, 600, 1200, 2400, 4800};
constexpr int sample_numbers[] = {4, 16};

// One setting of the sweep.
struct Setting {
  PatchIndex patches = 0;
  int samples = 0;
  double error = 0;
  double cpu_seconds = 0;
};

// At least so many patches, evenly, and then up to three times as many where they pay.
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

std::vector<Setting> sweep(const Scene& scene, const FinerReference& reference) {
  std::vector<Setting> settings;
  for (const std::size_t patches : uniform_meshes) {
    for (const int samples : sample_numbers) {
      const double begin = cpu_seconds();
      Request request;
      request.mesh.patches = patches;
      request.mesh.sides = Sides::front;
      request.assembly.samples = samples;
      const Simulation simulation = simulate(scene, request);
      const double cost = cpu_seconds() - begin;
      settings.push_back({simulation.mesh.size(), samples, error_against(reference, simulation).relative, cost});
    }
  }
  return settings;
}

std::optional<Setting> cheapest(const std::vector<Setting>& settings, double accuracy) {
  std::optional<Setting> best;
  for (const Setting& setting : settings) {
    if (setting.error <= accuracy && (!best || setting.cpu_seconds < best->cpu_seconds)) best = setting;
  }
  return best;
}

void print(const std::string& name, double asked, const FinerReference& reference, const std::vector<Setting>& settings,
           const Scene& scene) {
  const double begin = cpu_seconds();
  Request request;
  request.mesh.sides = Sides::front;
  request.accuracy.relative_error = asked;
  try {
    const Simulation simulation = simulate(scene, request);
    const double cost = cpu_seconds() - begin;
    const TrueError error = error_against(reference, simulation);
    const Field bar = simulation.error_bars->total();
    const AccuracyStep& step = simulation.accuracy.back();
    std::printf("| %s | %g %% | %.2f %% | %.2f %% | %.0f %% | %.1f | %u, %d | %.2f |", name.c_str(), 100 * asked,
                100 * error.relative, 100 * step.total, 100 * covered(error.of_patches, bar),
                median(bar) / median(error.of_patches), step.patches, step.samples, cost);
    if (const auto best = cheapest(settings, asked)) {
      std::printf(" %u, %d: %.2f | %.1f |\n", best->patches, best->samples, best->cpu_seconds,
                  cost / best->cpu_seconds);
    } else {
      std::printf(" none | |\n");
    }
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
  const bool sweeps = count < 2 || std::string(values[1]) != "--no-sweep";
  if (!sweeps) {
    --count;
    ++values;
  }
  if (count < 4) {
    std::fputs("usage: benchmark_accuracy [--no-sweep] REFERENCE_PATCHES ACCURACIES MODEL...\n", stderr);
    return 1;
  }
  const auto patches = static_cast<std::size_t>(std::strtoul(values[1], nullptr, 10));
  std::puts(
      "| room | asked | true | stated | patches within their bar | median bar / median error | patches, samples | CPU "
      "s "
      "| cheapest uniform setting: patches, samples: CPU s | ratio |\n|---|---|---|---|---|---|---|---|---|---|");
  for (int k = 3; k < count; ++k) {
    const Scene scene = read_scene(values[k]);
    const Simulation finer = finest(scene, patches);
    const FinerReference reference = reference_of(finer);
    const std::vector<Setting> settings = sweeps ? sweep(scene, reference) : std::vector<Setting>();
    for (const double asked : accuracies(values[2]))
      print(std::filesystem::path(values[k]).stem().string(), asked, reference, settings, scene);
    std::fprintf(stderr, "%s: reference of %u patches\n", values[k], finer.mesh.size());
  }
  return 0;
}
