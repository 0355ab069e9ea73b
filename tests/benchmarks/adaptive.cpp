// How many patches an accuracy takes when they are refined where it pays, and when they are all of one size.
// usage: benchmark_adaptive REFERENCE_ACCURACY ACCURACY UNIFORM MODEL
// Accuracies in percent, the first far lower than the second; UNIFORM: numbers of patches, as 8000,16000.
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "base/parallel.h"
#include "support/finer_reference.h"

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace {

using namespace patchlight;
using namespace patchlight::test;

Request asked(double percentage) {
  Request request;
  request.mesh.sides = Sides::front;
  request.accuracy.relative_error = percentage / 100;
  return request;
}

Simulation finest(const Scene& scene, double percentage) {
  Request request = asked(percentage);
  request.assembly.samples = 32;
  request.assembly.seed = 77;
  return simulate(scene, request);
}

void print(const char* mesh, const Simulation& simulation, const FinerReference& reference, double seconds) {
  std::printf("| %s | %u | %.2f %% | %.1f |\n", mesh, simulation.mesh.size(),
              100 * error_against(reference, simulation).relative, seconds);
  std::fflush(stdout);
}

void adaptive(const Scene& scene, const FinerReference& reference, double percentage) {
  const double begin = cpu_seconds();
  double looking = 0;
  Steps steps;
  steps.look = [&](const Simulation& simulation) {
    const double now = cpu_seconds();
    print("adaptive", simulation, reference, now - begin - looking);
    looking += cpu_seconds() - now;
  };
  simulate(scene, asked(percentage), {}, steps);
}

void uniform(const Scene& scene, const FinerReference& reference, std::size_t patches) {
  const double begin = cpu_seconds();
  Request request;
  request.mesh.sides = Sides::front;
  request.mesh.patches = patches;
  request.assembly.storage = Storage::tiles;
  const Simulation simulation = simulate(scene, request);
  print("uniform", simulation, reference, cpu_seconds() - begin);
}

}  // namespace

int main(int count, char** values) {
  if (count != 5) {
    std::fputs("usage: benchmark_adaptive REFERENCE_ACCURACY ACCURACY UNIFORM MODEL\n", stderr);
    return 1;
  }
  const Scene scene = read_scene(values[4]);
  const Simulation finer = finest(scene, std::atof(values[1]));
  const FinerReference reference = reference_of(finer);
  std::printf(
      "Reference: %u patches, %.2f %% by its own error bars.\n\n| mesh | patches | true error | CPU s |\n"
      "|---|---|---|---|\n",
      finer.mesh.size(), 100 * finer.accuracy.back().total);
  adaptive(scene, reference, std::atof(values[2]));
  std::istringstream numbers(values[3]);
  for (std::string one; std::getline(numbers, one, ',');) uniform(scene, reference, std::stoul(one));
  return 0;
}
