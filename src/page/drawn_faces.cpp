#include "page/drawn_faces.h"

#include "patchlight/views/picture.h"

#include "base/tolerances.h"
#include "light/photometry.h"
#include "render/tone_map.h"
#include "scene/triangulate.h"
#include "views/solved_light.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <zlib.h>

namespace patchlight {
namespace {

std::string by_planes(std::string_view bytes, std::size_t width) {
  const std::size_t count = bytes.size() / width;
  std::string planes(bytes.size(), '\0');
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t byte = 0; byte < width; ++byte) planes[byte * count + k] = bytes[k * width + byte];
  }
  return planes;
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  const int error = compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                              bytes.size(), Z_DEFAULT_COMPRESSION);
  // With as much room as zlib wants, nothing else can be wrong.
  if (error != Z_OK) throw std::bad_alloc();
  out.resize(size);
  return out;
}

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

// True when no part of a patch lies free: its exposed area is then rounding.
bool is_covered(const Simulation& simulation, PatchIndex patch) {
  return simulation.problem.area[patch] <= tolerance_of_coordinates * simulation.mesh.area[patch];
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

using Json = nlohmann::ordered_json;
using Colours = std::vector<std::array<std::uint8_t, 3>>;

// Degrees above the horizon: sky and ground meet at it.
constexpr std::array<double, 18> elevations = {-90, -60, -40, -25, -10, -0.1, 0.1, 4,  8,
                                               13,  19,  26,  34,  43,  53,   64,  76, 90};
constexpr int in_a_ring = 48;

std::vector<Vector> directions_around(const Vector& up) {
  const Vector across = up.unitOrthogonal();
  const Vector ahead = up.cross(across);
  std::vector<Vector> directions;
  for (const double elevation : elevations) {
    const double height = elevation * std::numbers::pi / 180;
    for (int k = 0; k < in_a_ring; ++k) {
      const double azimuth = 2 * std::numbers::pi * k / in_a_ring;
      const Vector level = std::cos(azimuth) * ahead + std::sin(azimuth) * across;
      directions.emplace_back(std::cos(height) * level + std::sin(height) * up);
    }
  }
  return directions;
}

Json colours_part(const Colours& colours) {
  const std::uint8_t* const first = colours.empty() ? nullptr : colours.front().data();
  return packed_array<std::uint8_t>({first, 3 * colours.size()}, 3);
}

// Radiances, one row for each direction; no rows without a sky.
Field radiance_of_sky(const SolvedSurface& surface) {
  const auto sky = sky_of(surface.simulation);
  if (!sky) return {};
  const std::vector<Vector> directions = directions_around(surface.scene.up.normalized());
  Field radiance(static_cast<Eigen::Index>(directions.size()), surface.simulation.solution.radiosity.cols());
  for (Eigen::Index row = 0; row < radiance.rows(); ++row)
    radiance.row(row) = sky(directions[static_cast<std::size_t>(row)]);
  return radiance;
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t group = 0;
    for (std::size_t byte = 0; byte < 3; ++byte)
      group = group << 8 | (byte < count ? static_cast<std::uint8_t>(bytes[k + byte]) : 0U);
    for (std::size_t letter = 0; letter < 4; ++letter)
      text += letter <= count ? letters[group >> (18 - 6 * letter) & 63U] : '=';
  }
  return text;
}

std::string packed_text(std::string_view bytes, std::size_t width) { return base64(deflated(by_planes(bytes, width))); }

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

std::vector<Look> looks_of(const SolvedSurface& surface, double exposure) {
  const Simulation& simulation = surface.simulation;
  if (simulation.enclosed.size() == 0) return {{"natural", exposure}};
  const Field radiance = display_radiance(simulation);
  const Eigen::VectorXd inside = simulation.problem.area.cwiseProduct(simulation.enclosed);
  const Eigen::VectorXd outside = simulation.problem.area - inside;
  if (!is_lit(radiance, inside) || !is_lit(radiance, outside)) return {{"natural", exposure}};
  const Bands bands = bands_of(surface.scene);
  const Look of_inside{"natural, exposed for the inside", exposure_for(radiance, inside, bands)};
  const Look of_outside{"natural, exposed for the outside", exposure_for(radiance, outside, bands)};
  const auto ratio = [exposure](const Look& look) { return std::abs(std::log(exposure / look.exposure)); };
  if (ratio(of_inside) <= ratio(of_outside)) return {{of_inside.name, exposure}, of_outside};
  return {{of_outside.name, exposure}, of_inside};
}

Json looks_part(const SolvedSurface& surface, double exposure, std::size_t most_faces) {
  const Bands bands = bands_of(surface.scene);
  const Field sky = radiance_of_sky(surface);
  Json part = Json::array();
  for (const Look& look : looks_of(surface, exposure)) {
    Json entry{{"name", look.name}, {"exposure", look.exposure}};
    entry["colours"] = colours_part(drawn_faces(surface, look.exposure, most_faces).colours);
    if (sky.rows() > 0) entry["sky"] = colours_part(tone_map(sky, look.exposure, bands));
    part.push_back(std::move(entry));
  }
  return part;
}

Json sky_directions(const SolvedSurface& surface) {
  if (!surface.scene.sky) return nullptr;
  std::vector<float> numbers;
  for (const Vector& direction : directions_around(surface.scene.up.normalized())) {
    for (const double coordinate : direction) numbers.push_back(static_cast<float>(coordinate));
  }
  return {{"in_a_ring", in_a_ring}, {"directions", packed_array<float>(numbers, 3)}};
}

}  // namespace patchlight
