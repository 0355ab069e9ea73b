// Light in gaps by rows of rays against paths: prints a row of the table in docs/hard_cases.md for each face in a gap.
// usage: benchmark_gaps PATCHES [no-lines] [ROOM...]
#include "patchlight/simulate.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "support/scenes.h"
#include "verify/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

using namespace test;

// Paths to a whole face, and to each of some of its patches.
constexpr std::uint32_t paths_to_face = 1U << 20;
constexpr std::uint32_t paths_to_patch = 2048;
constexpr std::size_t patches_traced = 300;

// A rectangle of a face in a gap, its normal along an axis.
struct InGap {
  std::string name;
  int axis = 0;
  bool looks_up = false;  // along the axis
  Point low, high;        // the same along it
};

struct Room {
  std::string name;
  std::vector<std::pair<Point, Point>> boxes;
  std::vector<InGap> faces;
};

Room box_above(const std::string& name, double height) {
  return {name,
          {{Point(1.1, 0.9, height), Point(2.3, 1.7, height + 1)}},
          {{"underside", 2, false, Point(1.1, 0.9, height), Point(2.3, 1.7, height)},
           {"floor below", 2, true, Point(1.1, 0.9, 0), Point(2.3, 1.7, 0)}}};
}

std::vector<Room> rooms() {
  return {box_above("box 1 mm over the floor", 0.001),
          box_above("box 5 mm over the floor", 0.005),
          box_above("box 2 cm over the floor", 0.02),
          {"board 1 cm before a wall",
           {{Point(0.01, 0.8, 0.5), Point(0.04, 2.1, 1.9)}},
           {{"its back", 0, false, Point(0.01, 0.8, 0.5), Point(0.01, 2.1, 1.9)},
            {"wall behind", 0, true, Point(0, 0.8, 0.5), Point(0, 2.1, 1.9)}}},
          {"drawer in a cupboard",
           {{Point(0, 1, 0.60), Point(0.6, 2, 0.62)},
            {Point(0, 1, 0.85), Point(0.6, 2, 0.87)},
            {Point(0.05, 1.05, 0.63), Point(0.55, 1.95, 0.65)},
            {Point(0.53, 1.05, 0.65), Point(0.55, 1.95, 0.84)}},
           {{"under the drawer", 2, false, Point(0.05, 1.05, 0.63), Point(0.55, 1.95, 0.63)},
            {"shelf below", 2, true, Point(0.05, 1.05, 0.62), Point(0.55, 1.95, 0.62)},
            {"inside the drawer", 2, true, Point(0.05, 1.05, 0.65), Point(0.53, 1.95, 0.65)},
            {"top over it", 2, false, Point(0.05, 1.05, 0.85), Point(0.53, 1.95, 0.85)}}}};
}

Scene scene_of(const Room& room) {
  Scene scene = with_box(empty_scene({grey(0.6), grey(0, 10)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  scene =
      with_quad(std::move(scene), {Point(1.5, 1, 2.4), Point(1.5, 2, 2.4), Point(2.5, 2, 2.4), Point(2.5, 1, 2.4)}, 1);
  for (const auto& [low, high] : room.boxes) scene = with_box(std::move(scene), low, high, false);
  return scene;
}

Quad corners_of(const InGap& face) {
  const int u = (face.axis + 1) % 3;
  const int v = (face.axis + 2) % 3;
  const auto corner = [&](bool high_u, bool high_v) {
    Point point = face.low;
    if (high_u) point[u] = face.high[u];
    if (high_v) point[v] = face.high[v];
    return point;
  };
  Quad quad{corner(false, false), corner(true, false), corner(true, true), corner(false, true)};
  if (!face.looks_up) std::swap(quad[1], quad[3]);
  return quad;
}

// The share of a patch in the rectangle, by places.
double share_in(const InGap& face, const PatchMesh& mesh, PatchIndex patch) {
  constexpr int places = 16;
  const double away = std::abs(mesh.centroid[patch][face.axis] - face.low[face.axis]);
  if (away > 1e-6 || (mesh.normal[patch][face.axis] > 0) != face.looks_up) return 0;
  if (std::abs(mesh.normal[patch][face.axis]) < 0.5) return 0;
  const QuadPoints points(mesh.corner_points(patch).points);
  const int u = (face.axis + 1) % 3;
  const int v = (face.axis + 2) % 3;
  int inside = 0;
  for (int k = 0; k < places * places; ++k) {
    const Point point = points.at((k % places + 0.5) / places, (k / places + 0.5) / places);
    const bool in_u = point[u] > face.low[u] && point[u] < face.high[u];
    if (in_u && point[v] > face.low[v] && point[v] < face.high[v]) ++inside;
  }
  return static_cast<double>(inside) / (places * places);
}

PathEstimate traced(const Scene& scene, const std::vector<PathReceiver>& receivers, std::uint32_t paths) {
  return trace_irradiance(scene, kept_sides(scene, Sides::both), receivers, {.paths = paths});
}

// Patches of a face, each with its area in it.
struct Part {
  PatchIndex patch;
  double area;
};

// Root mean squares over some patches of a face: of the light, the differences from paths without the noise of these,
// and the bars.
void print_patches(const Scene& scene, const Simulation& simulation, const std::vector<Part>& parts) {
  const PatchMesh& mesh = simulation.mesh;
  const Field bars = simulation.error_bars->total();
  const std::size_t step = std::max<std::size_t>(1, parts.size() / patches_traced);
  std::vector<PathReceiver> receivers;
  for (std::size_t k = 0; k < parts.size(); k += step) {
    const PatchIndex i = parts[k].patch;
    receivers.push_back({mesh.corner_points(i).points, mesh.polygon[i], mesh.side[i]});
  }
  const PathEstimate paths = traced(scene, receivers, paths_to_patch);
  double light = 0, off = 0, bar = 0, chi_square = 0;
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    const Part& part = parts[k * step];
    const auto row = static_cast<Eigen::Index>(k);
    const double noise = paths.standard_error(row, 0) * paths.standard_error(row, 0);
    const double square = std::pow(simulation.solution.irradiance(part.patch, 0) - paths.irradiance(row, 0), 2);
    const double stated = bars(part.patch, 0) * bars(part.patch, 0);
    light += part.area * std::pow(paths.irradiance(row, 0), 2);
    off += part.area * (square - noise);
    bar += part.area * stated;
    if (square > 0) chi_square += square / (stated + noise) / static_cast<double>(receivers.size());
  }
  std::printf(" %.1f | %.1f | %.2f |\n", 100 * std::sqrt(std::max(0.0, off) / light), 100 * std::sqrt(bar / light),
              chi_square);
}

void print_face(const Scene& scene, const Simulation& simulation, const InGap& face) {
  const Field bars = simulation.error_bars->total();
  std::vector<Part> parts;
  double area = 0, light = 0, bar = 0;
  PathReceiver whole{corners_of(face)};
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    const double part = share_in(face, simulation.mesh, i) * simulation.mesh.area[i];
    if (part == 0) continue;
    area += part;
    light += part * simulation.solution.irradiance(i, 0);
    bar += part * bars(i, 0);
    whole.polygon = simulation.mesh.polygon[i], whole.side = simulation.mesh.side[i];
    if (part > 0.99 * simulation.mesh.area[i]) parts.push_back({i, part});
  }
  const PathEstimate paths = traced(scene, {whole}, paths_to_face);
  const double wanted = paths.irradiance(0, 0);
  std::printf(" %s | %zu | %.4g | %.1f | %+.1f | %.1f |", face.name.c_str(), parts.size(), wanted,
              100 * paths.standard_error(0, 0) / wanted, 100 * (light / area / wanted - 1), 100 * bar / area / wanted);
  print_patches(scene, simulation, parts);
}

void print_room(const Room& room, Request request) {
  const Scene scene = scene_of(room);
  const double start = cpu_seconds();
  const Simulation simulation = simulate(scene, request);
  const double seconds = cpu_seconds() - start;
  for (const InGap& face : room.faces) {
    std::printf("| %s | %u | %.2f |", room.name.c_str(), static_cast<unsigned>(simulation.mesh.size()), seconds);
    print_face(scene, simulation, face);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace patchlight

int main(int count, char** words) {
  using namespace patchlight;
  if (count < 2) return std::fputs("usage: benchmark_gaps PATCHES [no-lines] [ROOM...]\n", stderr), 1;
  Request request;
  request.mesh.patches = std::strtoul(words[1], nullptr, 10);
  request.mesh.sides = Sides::both;
  request.assembly.storage = Storage::rays;
  request.solver.solver = Solver::gmres;
  std::vector<std::string> names;
  for (int k = 2; k < count; ++k) {
    const std::string word = words[k];
    if (word == "no-lines") {
      request.mesh.contact_lines = false;
    } else {
      names.push_back(word);
    }
  }
  std::puts(
      "| room | patches | CPU s | face | patches on it | light by paths, W/m² | known to, % | off, % | bar, % | "
      "patches "
      "off, % | their bars, % | chi-square |\n|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (const Room& room : rooms()) {
    const bool wanted =
        std::any_of(names.begin(), names.end(), [&](const std::string& name) { return room.name.rfind(name, 0) == 0; });
    if (names.empty() || wanted) print_room(room, request);
  }
}
