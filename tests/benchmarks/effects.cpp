// What leaving an effect out saves, on a scene made for it: the table of docs/benchmarks/speed.md, in Markdown, and how
// exact expected_cost() is.
// usage: benchmark_effects [PATCHES]
#include "patchlight/simulate.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "pipeline/expected_cost.h"
#include "plan/effect_facts.h"
#include "support/effect_scenes.h"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace patchlight;
using namespace patchlight::test;

struct Case {
  Effect effect;
  std::string scene;
  Scene built;
  Sides sides = Sides::front;
  bool close = true;
};

std::vector<Case> cases() {
  const Spectrum lamp = rgb(10, 7, 3);
  return {{Effect::occlusion, "an empty room", lit_box(0.5)},
          {Effect::interreflection, "a black room, not closed", furnished_room(0), Sides::front, false},
          {Effect::colour, "grey walls, yellow lamps", in_colours(rgb(0.5, 0.5, 0.5), lamp, 2 * lamp)},
          {Effect::reach, "a dark room beside", two_rooms(0.5), Sides::automatic},
          {Effect::backs, "a closed room", furnished_room(0.5), Sides::automatic},
          {Effect::sun, "a closed room", with_daylight(furnished_room(0.5))},
          {Effect::sky, "a closed room", with_daylight(furnished_room(0.5))},
          {Effect::closure, "a black room", furnished_room(0)}};
}

struct Cost {
  double cpu = 0;
  double planning = 0;
  std::size_t patches = 0;
  double expected = 0;
};

Cost cost_of(const Scene& scene, const Request& request) {
  Cost cost;
  const double start = cpu_seconds();
  const Simulation simulation = simulate(scene, request);
  const double end = cpu_seconds();
  cost.cpu = end - start;
  cost.patches = simulation.mesh.size();
  const double planning = cpu_seconds();
  survey_effects(scene, simulation.plan.sides);
  cost.planning = cpu_seconds() - planning;
  const ExpectedCost expected = expected_cost(scene, simulation.plan, simulation.mesh);
  cost.expected = expected.form_factor_seconds + expected.direct_light_seconds + expected.solve_seconds;
  return cost;
}

void print_row(const Case& test, std::size_t patches) {
  Request request;
  request.mesh.sides = test.sides;
  request.assembly.close = test.close;
  request.mesh.max_edge = max_edge_for(test.built, kept_sides(test.built, test.sides), patches);
  const Cost planned = cost_of(test.built, request);
  request.effects.force = {test.effect};
  const Cost forced = cost_of(test.built, request);
  std::printf("| %s | %s | %zu | %.2f (%.2f) | %zu | %.2f (%.2f) | %.1f | %.2f %% |\n", name_of(test.effect),
              test.scene.c_str(), forced.patches, forced.cpu, forced.expected, planned.patches, planned.cpu,
              planned.expected, forced.cpu / planned.cpu, 100 * planned.planning / planned.cpu);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** values) {
  const std::size_t patches = count > 1 ? std::strtoul(values[1], nullptr, 10) : 4000;
  std::puts(
      "| effect | scene | patches | CPU s simulated (expected) | patches | CPU s left out (expected) | ratio | survey "
      "|");
  std::puts("|---|---|---|---|---|---|---|---|");
  for (const Case& test : cases()) print_row(test, patches);
}
