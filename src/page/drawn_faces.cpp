#include "page/drawn_faces.h"

#include "light/photometry.h"
#include "render/tone_map.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <span>

namespace patchlight {
namespace {

// One side of a polygon, and how it is drawn.
struct DrawnSide {
  PatchRange patches;
  std::size_t triangles = 0;  // of the polygon
  double area = 0;
  double scatter = 0;  // integral of the squared difference of luminance from the mean
  bool whole = false;  // the polygon in place of its patches

  bool is_covered = false;  // wholly

  std::size_t size() const { return patches.end - patches.begin; }
  std::size_t saving() const { return size() > triangles ? size() - triangles : 0; }
};

// Does no part of a patch lie free? Its exposed area is then rounding.
bool is_covered(const Simulation& simulation, PatchIndex patch) {
  constexpr double least_exposed = 1e-6;
  return simulation.problem.area[patch] <= least_exposed * simulation.mesh.area[patch];
}

DrawnSide drawn_side(const SolvedSurface& surface, const PatchRange& patches) {
  const PatchMesh& mesh = surface.simulation.mesh;
  const Field& radiosity = surface.simulation.solution.radiosity;
  const Bands bands = bands_of(surface.scene);
  DrawnSide side{patches, surface.scene.polygons[mesh.polygon[patches.begin]].corners.size() - 2};
  double sum = 0, squares = 0;
  side.is_covered = true;
  for (PatchIndex patch = patches.begin; patch < patches.end; ++patch) {
    const double value = luminance(radiosity.row(patch), bands);
    side.area += mesh.area[patch];
    side.is_covered = side.is_covered && is_covered(surface.simulation, patch);
    sum += mesh.area[patch] * value;
    squares += mesh.area[patch] * value * value;
  }
  side.scatter = squares - sum * sum / side.area;
  return side;
}

std::vector<DrawnSide> all_sides(const SolvedSurface& surface) {
  const std::vector<PatchIndex>& first = surface.simulation.mesh.first_patch;
  std::vector<DrawnSide> sides;
  for (std::size_t slot = 0; slot + 1 < first.size(); ++slot) {
    if (first[slot] < first[slot + 1]) sides.push_back(drawn_side(surface, {first[slot], first[slot + 1]}));
  }
  return sides;
}

// Those with the least to lose for each face that is saved become whole first; then the smallest are left out.
std::vector<DrawnSide> thinned(std::vector<DrawnSide> sides, std::size_t faces, std::size_t most) {
  const auto rest =
      std::stable_partition(sides.begin(), sides.end(), [](const DrawnSide& side) { return side.saving() > 0; });
  std::stable_sort(sides.begin(), rest, [](const DrawnSide& a, const DrawnSide& b) {
    return a.scatter * static_cast<double>(b.saving()) < b.scatter * static_cast<double>(a.saving());
  });
  for (DrawnSide& side : sides) {
    if (faces <= most) break;
    side.whole = side.saving() > 0;
    faces -= side.saving();
  }
  std::stable_sort(sides.begin(), sides.end(), [](const DrawnSide& a, const DrawnSide& b) { return a.area > b.area; });
  while (faces > most && !sides.empty()) {
    faces -= sides.back().whole ? sides.back().triangles : sides.back().size();
    sides.pop_back();
  }
  return sides;
}

void draw_patches(DrawnFaces& drawn, const Simulation& simulation, const PatchRange& patches) {
  const PatchMesh& mesh = simulation.mesh;
  for (PatchIndex patch = patches.begin; patch < patches.end; ++patch) {
    if (is_covered(simulation, patch)) {
      ++drawn.covered;
      continue;
    }
    drawn.row.push_back(static_cast<std::uint32_t>(drawn.patches.size()));
    drawn.patches.push_back({patch, patch + 1});
    drawn.corners.push_back(mesh.corners[patch]);
  }
}

void draw_whole(DrawnFaces& drawn, const SolvedSurface& surface, const DrawnSide& side, double exposure) {
  const PatchMesh& mesh = surface.simulation.mesh;
  const std::vector<Point> outline = corner_points(surface.scene, mesh.polygon[side.patches.begin]);
  Field mean = Field::Zero(1, surface.simulation.solution.radiosity.cols());
  for (PatchIndex patch = side.patches.begin; patch < side.patches.end; ++patch)
    mean += mesh.area[patch] / side.area * surface.simulation.solution.radiosity.row(patch);
  const auto colour = tone_map(mean / std::numbers::pi, exposure, bands_of(surface.scene)).front();
  const auto first = static_cast<std::uint32_t>(drawn.vertices.size());
  drawn.vertices.insert(drawn.vertices.end(), outline.begin(), outline.end());
  drawn.colours.insert(drawn.colours.end(), outline.size(), colour);
  for (auto [a, b, c] : triangulate(outline)) {
    if (mesh.side[side.patches.begin] == Side::back) std::swap(b, c);
    drawn.corners.push_back({first + a, first + b, first + c, first + c});
    drawn.row.push_back(static_cast<std::uint32_t>(drawn.patches.size()));
  }
  drawn.patches.push_back(side.patches);
}

// Without the vertices of which no face is left.
DrawnFaces without_unused(DrawnFaces drawn) {
  std::vector<std::uint32_t> place(drawn.vertices.size(), 0);
  for (const auto& face : drawn.corners) {
    for (const std::uint32_t corner : face) place[corner] = 1;
  }
  std::uint32_t next = 0;
  for (std::size_t vertex = 0; vertex < place.size(); ++vertex) {
    if (place[vertex] == 0) continue;
    drawn.vertices[next] = drawn.vertices[vertex];
    drawn.colours[next] = drawn.colours[vertex];
    place[vertex] = next++;
  }
  drawn.vertices.resize(next);
  drawn.colours.resize(next);
  for (auto& face : drawn.corners) {
    for (std::uint32_t& corner : face) corner = place[corner];
  }
  return drawn;
}

}  // namespace

DrawnFaces drawn_faces(const SolvedSurface& surface, double exposure, std::size_t most) {
  const PatchMesh& mesh = surface.simulation.mesh;
  DrawnFaces drawn;
  drawn.vertices = mesh.vertices;
  drawn.colours = tone_map(surface.radiance_at_vertices, exposure, bands_of(surface.scene));
  if (mesh.size() <= most) {
    draw_patches(drawn, surface.simulation, {0, mesh.size()});
    return drawn.covered == 0 ? drawn : without_unused(std::move(drawn));
  }
  std::vector<DrawnSide> sides = all_sides(surface);
  std::size_t faces = mesh.size();
  std::erase_if(sides, [&](const DrawnSide& side) {
    if (!side.is_covered) return false;
    drawn.covered += side.size();
    faces -= side.size();
    return true;
  });
  sides = thinned(std::move(sides), faces, most);
  std::sort(sides.begin(), sides.end(),
            [](const DrawnSide& a, const DrawnSide& b) { return a.patches.begin < b.patches.begin; });
  drawn.left_out = faces;
  for (const DrawnSide& side : sides) {
    drawn.left_out -= side.size();
    if (side.whole) draw_whole(drawn, surface, side, exposure);
    if (!side.whole) draw_patches(drawn, surface.simulation, side.patches);
  }
  return without_unused(std::move(drawn));
}

}  // namespace patchlight
