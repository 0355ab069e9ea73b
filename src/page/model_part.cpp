#include "page/model_part.h"

#include "light/photometry.h"
#include "output/report/json_array.h"
#include "page/drawn_faces.h"
#include "page/looks.h"
#include "page/packed.h"
#include "pipeline/world.h"
#include "scene/shells.h"
#include "scene/solids.h"
#include "solve/scattering.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace patchlight {
namespace {

using Json = nlohmann::ordered_json;

// Corners as multiples of the bounds' sizes over 65535: .15 mm in a room of ten metres.
Json positions_part(const std::vector<Point>& vertices) {
  Box box;
  for (const Point& vertex : vertices) box.extend(vertex);
  std::vector<std::uint16_t> steps;
  steps.reserve(3 * vertices.size());
  for (const Point& vertex : vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      const double size = box.sizes()[axis];
      const double share = size > 0 ? (vertex[axis] - box.min()[axis]) / size : 0;
      steps.push_back(static_cast<std::uint16_t>(std::lround(65535 * share)));
    }
  }
  Json part = packed_array<std::uint16_t>(steps, 3);
  part["low"] = json_array(vertices.empty() ? Point::Zero().eval() : box.min());
  part["high"] = json_array(vertices.empty() ? Point::Zero().eval() : box.max());
  return part;
}

// Means by area over the patches of each row.
class RowMeans {
 public:
  RowMeans(const DrawnFaces& drawn, const PatchMesh& mesh) : drawn_(drawn), mesh_(mesh) {}

  Field of(const FieldView& values) const {
    Field means(static_cast<Eigen::Index>(drawn_.patches.size()), values.cols());
    for (Eigen::Index row = 0; row < means.rows(); ++row) {
      const PatchRange& range = drawn_.patches[static_cast<std::size_t>(row)];
      // The value of one patch keeps its bits.
      means.row(row) = values.row(range.begin);
      if (range.end - range.begin == 1) continue;
      means.row(row) *= mesh_.area[range.begin];
      double area = mesh_.area[range.begin];
      for (PatchIndex patch = range.begin + 1; patch < range.end; ++patch) {
        means.row(row) += mesh_.area[patch] * values.row(patch);
        area += mesh_.area[patch];
      }
      means.row(row) /= area;
    }
    return means;
  }

 private:
  const DrawnFaces& drawn_;
  const PatchMesh& mesh_;
};

Json floats_part(const Field& values) {
  std::vector<float> numbers;
  numbers.reserve(static_cast<std::size_t>(values.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k) numbers.push_back(static_cast<float>(values.data()[k]));
  return packed_array<float>(numbers, static_cast<std::size_t>(values.cols()));
}

Field luminances(const Field& values, const Bands& bands) {
  Field one(values.rows(), 1);
  for (Eigen::Index row = 0; row < one.rows(); ++row) one(row, 0) = luminance(values.row(row), bands);
  return one;
}

// Names are those of the arrays in .vtp where these are the same; of errors the luminance.
Json values_part(const SolvedSurface& surface, const RowMeans& means) {
  const Simulation& simulation = surface.simulation;
  const Solution& solution = simulation.solution;
  const Bands bands = bands_of(surface.scene);
  Json part = Json::object();
  const auto add = [&](const char* name, const Field& values) {
    if (values.rows() == static_cast<Eigen::Index>(simulation.mesh.size())) part[name] = floats_part(means.of(values));
  };
  const auto add_luminous = [&](const char* name, const Field& values) {
    if (values.rows() == static_cast<Eigen::Index>(simulation.mesh.size())) add(name, luminances(values, bands));
  };
  const auto add_scattered = [&](const char* name, const Field& irradiance) {
    if (irradiance.rows() == static_cast<Eigen::Index>(simulation.mesh.size()))
      add_luminous(name,
                   reflected_error(simulation.problem.scattering, irradiance) / std::numbers::pi);  // dL = R dH / pi
  };
  add("radiance", solution.radiosity / std::numbers::pi);  // L = B / pi
  add("irradiance", solution.irradiance);
  add_luminous("luminance", solution.radiosity / std::numbers::pi);
  add_luminous("illuminance", solution.irradiance);
  add_luminous("direct_illuminance", solution.direct_irradiance);
  if (const auto& bars = simulation.error_bars) {
    add_scattered("error_total", bars->total());
    add_scattered("error_mesh", bars->mesh);
    add_scattered("error_form_factor", bars->form_factor);
    add_scattered("error_solver", bars->solver);
    add_scattered("display_error", bars->display);
    add_luminous("error_illuminance", bars->total());
    return part;
  }
  add_luminous("error_solver", solution.error / std::numbers::pi);
  add_scattered("error_form_factor", simulation.ray_standard_error);
  return part;
}

std::size_t slot_of(PolygonIndex polygon, Side side) {
  return 2 * std::size_t{polygon} + static_cast<std::size_t>(side);
}

// How many faces lie one on the other over a side of a polygon, at 2 * polygon + side: 0 where none does, and at most
// `deepest`. Empty where nothing overlaps.
std::vector<std::uint8_t> layers_of(const SolvedSurface& surface) {
  constexpr std::uint8_t deepest = 7;
  const Coverings& coverings = surface.simulation.world->tracing().coverings();
  std::vector<std::uint8_t> layers(coverings.over.size(), 0);
  const auto normal = [&](PolygonIndex polygon) { return area_vector(corner_points(surface.scene, polygon)); };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t slot = 0; slot < layers.size(); ++slot) {
      const auto polygon = static_cast<PolygonIndex>(slot / 2);
      for (const PolygonIndex upper : coverings.over[slot]) {
        const bool is_front = (slot % 2 == 0) == (normal(polygon).dot(normal(upper)) > 0);
        const std::uint8_t below = layers[slot_of(upper, is_front ? Side::front : Side::back)];
        if (layers[slot] > below || layers[slot] == deepest) continue;
        layers[slot] = static_cast<std::uint8_t>(below + 1);
        changed = true;
      }
    }
  }
  return layers;
}

// At 2 * polygon + side 1 for the sides that face the inside of a closed solid: these show where it is cut.
std::vector<std::uint8_t> sides_in_solids(const Scene& scene) {
  const Shells shells = shells_of(scene);
  return inner_sides(scene, shells, closed_solids(scene, shells));
}

// At 1 the patches that no light gets to, nor comes from, as between walls.
std::vector<std::uint8_t> dark_patches(const SolvedSurface& surface) {
  constexpr double nothing = 1e-12;
  const PatchMesh& mesh = surface.simulation.mesh;
  const Solution& solution = surface.simulation.solution;
  const bool knows_irradiance = solution.irradiance.rows() == solution.radiosity.rows();
  const auto is_black = [&](PatchIndex patch) {
    return !(surface.scene.materials[mesh.material[patch]].reflectance > 0).any();
  };
  std::vector<std::uint8_t> dark(mesh.size(), 0);
  const double least = nothing * solution.radiosity.maxCoeff();
  const double least_irradiance = knows_irradiance ? nothing * solution.irradiance.maxCoeff() : 0;
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    if ((solution.radiosity.row(patch) > least).any()) continue;
    // A stored solution has radiances alone, and a black surface has none where light gets to it.
    const bool is_lit = knows_irradiance ? (solution.irradiance.row(patch) > least_irradiance).any() : is_black(patch);
    dark[patch] = is_lit ? 0 : 1;
  }
  return dark;
}

// Per row: its patch or the first of them, how many they are, their area, and what they are made of. `layer` counts the
// faces that lie over it, `filled` is 1 before a closed solid, and `dark` is 1 where there is no light.
Json rows_part(const SolvedSurface& surface, const DrawnFaces& drawn) {
  const PatchMesh& mesh = surface.simulation.mesh;
  std::vector<std::uint32_t> first, count, face, material, group;
  std::vector<std::uint8_t> side, enclosed, layer, dark, filled;
  const std::vector<std::uint8_t> layers = layers_of(surface);
  const std::vector<std::uint8_t> inner = sides_in_solids(surface.scene);
  const std::vector<std::uint8_t> dark_patch = dark_patches(surface);
  std::vector<float> areas;
  const Eigen::VectorXd& holds_light = surface.simulation.enclosed;
  for (const PatchRange& range : drawn.patches) {
    const Polygon& polygon = surface.scene.polygons[mesh.polygon[range.begin]];
    double area = 0, area_enclosed = 0;
    for (PatchIndex patch = range.begin; patch < range.end; ++patch) {
      area += mesh.area[patch];
      if (holds_light.size() > 0) area_enclosed += mesh.area[patch] * holds_light[patch];
    }
    enclosed.push_back(2 * area_enclosed > area ? 1 : 0);
    first.push_back(range.begin);
    count.push_back(range.end - range.begin);
    areas.push_back(static_cast<float>(area));
    face.push_back(polygon.face);
    group.push_back(polygon.group);
    material.push_back(mesh.material[range.begin]);
    side.push_back(static_cast<std::uint8_t>(mesh.side[range.begin]));
    const std::size_t slot = slot_of(mesh.polygon[range.begin], mesh.side[range.begin]);
    layer.push_back(layers.empty() ? 0 : layers[slot]);
    filled.push_back(inner[slot ^ 1U]);
    const auto dark_from = dark_patch.begin() + range.begin, dark_to = dark_patch.begin() + range.end;
    dark.push_back(std::find(dark_from, dark_to, 0) == dark_to ? 1 : 0);
  }
  Json part = {{"patch", packed_array<std::uint32_t>(first, 1)},
               {"patches", packed_array<std::uint32_t>(count, 1)},
               {"area", packed_array<float>(areas, 1)},
               {"source_polygon", packed_array<std::uint32_t>(face, 1)},
               {"group_id", packed_array<std::uint32_t>(group, 1)},
               {"material_id", packed_array<std::uint32_t>(material, 1)},
               {"side", packed_array<std::uint8_t>(side, 1)},
               {"layer", packed_array<std::uint8_t>(layer, 1)},
               {"filled", packed_array<std::uint8_t>(filled, 1)},
               {"dark", packed_array<std::uint8_t>(dark, 1)}};
  if (holds_light.size() > 0) part["enclosed"] = packed_array<std::uint8_t>(enclosed, 1);
  return part;
}

// How much of the display's value of what lies behind a material it takes away: display values are about the 2.2nd root
// of radiances.
double opacity_of(const Material& material, const Spectrum& shares) {
  if (material.transmittance.size() == 0) return 1;
  return 1 - std::pow(std::clamp((shares * material.transmittance).sum(), 0.0, 1.0), 1 / 2.2);
}

// The names of materials with their opacity, and which have a picture.
void add_materials(Json& part, const SolvedSurface& surface) {
  const Spectrum shares = luminous_shares(bands_of(surface.scene));
  const PatchMesh& mesh = surface.simulation.mesh;
  for (const char* name : {"materials", "opacity", "textured"}) part[name] = Json::array();
  for (const Material& material : surface.scene.materials) {
    part["materials"].push_back(material.name);
    part["opacity"].push_back(opacity_of(material, shares));
  }
  std::vector<std::uint8_t> has_picture(surface.scene.materials.size(), 0);
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) has_picture[mesh.material[patch]] = 1;
  for (std::size_t k = 0; k < has_picture.size(); ++k) {
    const Material& material = surface.scene.materials[k];
    if (has_picture[k] != 0 && material.texture) part["textured"].push_back(material.name);
  }
}

}  // namespace

Json model_part(const SolvedSurface& surface, double exposure, std::size_t most_faces) {
  const DrawnFaces drawn = drawn_faces(surface, exposure, most_faces);
  const std::span<const std::uint32_t> corners(drawn.corners.empty() ? nullptr : drawn.corners.front().data(),
                                               4 * drawn.corners.size());
  Json part;
  part["patches"] = surface.simulation.mesh.size();
  part["faces"] = drawn.corners.size();
  part["patches_left_out"] = drawn.left_out;
  part["patches_covered"] = drawn.covered;
  part["up"] = json_array(surface.scene.up);
  part["photometric"] = surface.scene.photometric;
  part["bands"] = Json::array();
  for (const Band& band : bands_of(surface.scene)) part["bands"].push_back(band.name);
  add_materials(part, surface);
  part["groups"] = Json::array();
  for (std::uint32_t group = 0; group < surface.scene.groups.size(); ++group)
    part["groups"].push_back(group_name(surface.scene, group));
  part["positions"] = positions_part(drawn.vertices);
  part["looks"] = looks_part(surface, exposure, most_faces);
  if (surface.scene.sky) part["sky"] = sky_directions(surface);
  part["corners"] = packed_array<std::uint32_t>(corners, 4);
  part["row"] = packed_array<std::uint32_t>(drawn.row, 1);
  part["rows"] = rows_part(surface, drawn);
  part["values"] = values_part(surface, RowMeans(drawn, surface.simulation.mesh));
  return part;
}

}  // namespace patchlight
