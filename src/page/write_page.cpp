#include "page/write_page.h"

#include "patchlight/gather/readings.h"
#include "patchlight/scene/scene.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "light/photometry.h"
#include "output/file/whole_file.h"
#include "output/image/write_image.h"
#include "output/plot/write_sensor_map.h"
#include "output/report/report_json.h"
#include "output/report/write_study.h"
#include "page/drawn_faces.h"
#include "pipeline/world.h"
#include "scene/solids.h"
#include "solve/scattering.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

namespace patchlight {
namespace {

using Json = nlohmann::ordered_json;

void append_place(std::vector<float>& numbers, const Point& place) {
  for (const double coordinate : place) numbers.push_back(static_cast<float>(coordinate));
}

Json cells_of_grid(const SensorGroup& group) {
  std::vector<float> corners;
  for (const auto& cell : group.cells) {
    for (const Point& corner : cell) append_place(corners, corner);
  }
  return packed_array<float>(corners, 12);
}

Json sensor_map(const Scene& scene, const SensorGroup& group, const Readings& readings, std::size_t first) {
  std::vector<float> places, values, errors, factors;
  for (std::size_t k = 0; k < group.sensors.size(); ++k) {
    const SensorValue value = sensor_value(readings, first + k);
    append_place(places, group.sensors[k].point);
    values.push_back(static_cast<float>(value.value));
    errors.push_back(static_cast<float>(value.standard_error));
    if (readings.outside_by_sky) factors.push_back(static_cast<float>(daylight_factor(readings, first + k)));
  }
  Json part{{"name", group.name}, {"unit", sensor_unit(readings)}};
  const MapAxes axes = map_axes(group.sensors[0].normal, scene.up, scene.north);
  part["right"] = json_array(axes.right);
  part["above"] = json_array(axes.above);
  part["places"] = packed_array<float>(places, 3);
  part["values"] = packed_array<float>(values, 1);
  part["standard_errors"] = packed_array<float>(errors, 1);
  if (readings.outside_by_sky) part["daylight_factors"] = packed_array<float>(factors, 1);
  if (!group.cells.empty()) part["cells"] = cells_of_grid(group);
  return part;
}

// Per group of sensors its name, unit, the axes of its map (map_axes()), places, values, standard errors, daylight
// factors where there are any, and of a grid the cells.
Json sensor_maps(const Scene& scene, const Readings& readings) {
  Json maps = Json::array();
  std::size_t first = 0;
  for (const SensorGroup& group : scene.sensors) {
    if (group.sensors.empty()) continue;
    maps.push_back(sensor_map(scene, group, readings, first));
    first += group.sensors.size();
  }
  return maps;
}

// The bounds of a page's model have so many steps along each axis: 0.06 mm in a terrain of a kilometer. Larger steps
// would open gaps along the edges of faces.
constexpr std::uint32_t position_steps = (1U << 24) - 1;

// Corners in these steps.
Json positions_part(const std::vector<Point>& vertices) {
  Box box;
  for (const Point& vertex : vertices) box.extend(vertex);
  std::vector<std::uint32_t> steps;
  steps.reserve(3 * vertices.size());
  for (const Point& vertex : vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      const double size = box.sizes()[axis];
      const double share = size > 0 ? (vertex[axis] - box.min()[axis]) / size : 0;
      steps.push_back(static_cast<std::uint32_t>(std::lround(position_steps * share)));
    }
  }
  Json part = packed_array<std::uint32_t>(steps, 3);
  part["steps"] = position_steps;
  part["low"] = json_array(vertices.empty() ? Point::Zero().eval() : box.min());
  part["high"] = json_array(vertices.empty() ? Point::Zero().eval() : box.max());
  return part;
}

// Means by area over the patches of each row.
Field row_means(const FieldView& values, const DrawnFaces& drawn, const PatchMesh& mesh) {
  Field means(static_cast<Eigen::Index>(drawn.patches.size()), values.cols());
  for (Eigen::Index row = 0; row < means.rows(); ++row) {
    const PatchRange& range = drawn.patches[static_cast<std::size_t>(row)];
    // The value of one patch keeps its bits.
    means.row(row) = values.row(range.begin);
    if (range.end - range.begin == 1) continue;
    means.row(row) *= mesh.area[range.begin];
    double area = mesh.area[range.begin];
    for (PatchIndex patch = range.begin + 1; patch < range.end; ++patch) {
      means.row(row) += mesh.area[patch] * values.row(patch);
      area += mesh.area[patch];
    }
    means.row(row) /= area;
  }
  return means;
}

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
Json values_part(const SolvedSurface& surface, const DrawnFaces& drawn) {
  const Simulation& simulation = surface.simulation;
  const Solution& solution = simulation.solution;
  const Bands bands = bands_of(surface.scene);
  Json part = Json::object();
  const auto is_known = [&](const Field& values) {
    return values.rows() == static_cast<Eigen::Index>(simulation.mesh.size());
  };
  const auto add = [&](const char* name, const Field& values) {
    if (is_known(values)) part[name] = floats_part(row_means(values, drawn, simulation.mesh));
  };
  const auto add_luminous = [&](const char* name, const Field& values) {
    if (is_known(values)) add(name, luminances(values, bands));
  };
  const auto add_scattered = [&](const char* name, const Field& irradiance) {  // dL = R dH / pi
    if (is_known(irradiance))
      add_luminous(name, reflected_error(simulation.problem.scattering, irradiance) / std::numbers::pi);
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

// At 1 the patches that no light gets to, nor comes from, as between walls.
std::vector<std::uint8_t> dark_patches(const SolvedSurface& surface) {
  const PatchMesh& mesh = surface.simulation.mesh;
  const Solution& solution = surface.simulation.solution;
  const bool knows_irradiance = solution.irradiance.rows() == solution.radiosity.rows();
  const auto is_black = [&](PatchIndex patch) {
    return !(surface.scene.materials[mesh.material[patch]].reflectance > 0).any();
  };
  std::vector<std::uint8_t> dark(mesh.size(), 0);
  const double least = tolerance_of_arithmetic * solution.radiosity.maxCoeff();
  const double least_irradiance = knows_irradiance ? tolerance_of_arithmetic * solution.irradiance.maxCoeff() : 0;
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    if ((solution.radiosity.row(patch) > least).any()) continue;
    // A stored solution has radiances alone, and a black surface has none where light gets to it.
    const bool is_lit = knows_irradiance ? (solution.irradiance.row(patch) > least_irradiance).any() : is_black(patch);
    dark[patch] = is_lit ? 0 : 1;
  }
  return dark;
}

template <class Number, class ValueOf>
Json per_row(const DrawnFaces& drawn, const ValueOf& value_of) {
  std::vector<Number> values;
  for (const PatchRange& range : drawn.patches) values.push_back(static_cast<Number>(value_of(range)));
  return packed_array<Number>(values, 1);
}

// Per row: its patch or the first of them, how many they are, their area and material. `layer` counts the faces that
// lie over it, `filled` is 1 before a closed solid, and `dark` is 1 where there is no light.
Json rows_part(const SolvedSurface& surface, const DrawnFaces& drawn) {
  using Byte = std::uint8_t;
  using Number = std::uint32_t;
  const PatchMesh& mesh = surface.simulation.mesh;
  const Eigen::VectorXd& holds_light = surface.simulation.enclosed;
  const std::vector<Byte> layers = layers_of(surface);
  // The sides that face the inside of a closed solid show where it is cut.
  const std::shared_ptr<const SceneGeometry> geometry = geometry_of(surface.scene, surface.simulation.plan.sides);
  const std::vector<Byte>& inner = geometry->inner;
  const std::vector<Byte> dark_patch = dark_patches(surface);
  const auto polygon_of = [&](const PatchRange& range) -> const Polygon& {
    return surface.scene.polygons[mesh.polygon[range.begin]];
  };
  const auto slot = [&](const PatchRange& range) { return slot_of(mesh.polygon[range.begin], mesh.side[range.begin]); };
  const auto area_of = [&](const PatchRange& range, const auto& share_of) {
    double area = 0;
    for (PatchIndex patch = range.begin; patch < range.end; ++patch) area += mesh.area[patch] * share_of(patch);
    return area;
  };
  const auto whole = [&](const PatchRange& range) { return area_of(range, [](PatchIndex) { return 1.0; }); };
  const auto is_dark = [&](const PatchRange& range) {
    return std::all_of(dark_patch.begin() + range.begin, dark_patch.begin() + range.end, [](Byte k) { return k != 0; });
  };
  Json part;
  part["patch"] = per_row<Number>(drawn, [](const PatchRange& range) { return range.begin; });
  part["patches"] = per_row<Number>(drawn, [](const PatchRange& range) { return range.end - range.begin; });
  part["area"] = per_row<float>(drawn, whole);
  part["source_polygon"] = per_row<Number>(drawn, [&](const PatchRange& range) { return polygon_of(range).face; });
  part["group_id"] = per_row<Number>(drawn, [&](const PatchRange& range) { return polygon_of(range).group; });
  part["material_id"] = per_row<Number>(drawn, [&](const PatchRange& range) { return mesh.material[range.begin]; });
  part["side"] = per_row<Byte>(drawn, [&](const PatchRange& range) { return mesh.side[range.begin]; });
  part["layer"] =
      per_row<Byte>(drawn, [&](const PatchRange& range) { return layers.empty() ? 0 : layers[slot(range)]; });
  part["filled"] = per_row<Byte>(drawn, [&](const PatchRange& range) { return inner[slot(range) ^ 1U]; });
  part["dark"] = per_row<Byte>(drawn, is_dark);
  if (holds_light.size() == 0) return part;
  part["enclosed"] = per_row<Byte>(drawn, [&](const PatchRange& range) {
    return 2 * area_of(range, [&](PatchIndex patch) { return holds_light[patch]; }) > whole(range);
  });
  return part;
}

// The share of the display's value behind a material that it takes away: display values are about the 2.2nd root of
// radiances.
double opacity_of(const Material& material, const Spectrum& shares) {
  if (material.transmittance.size() == 0) return 1;
  return 1 - std::pow(std::clamp((shares * material.transmittance).sum(), 0.0, 1.0), 1 / 2.2);
}

// The names of materials with their opacity, and which have a picture or are mirrors.
void add_materials(Json& part, const SolvedSurface& surface) {
  const Spectrum shares = luminous_shares(bands_of(surface.scene));
  const PatchMesh& mesh = surface.simulation.mesh;
  for (const char* name : {"materials", "opacity", "textured", "mirrors"}) part[name] = Json::array();
  for (const Material& material : surface.scene.materials) {
    part["materials"].push_back(material.name);
    part["opacity"].push_back(opacity_of(material, shares));
  }
  std::vector<std::uint8_t> is_used(surface.scene.materials.size(), 0);
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) is_used[mesh.material[patch]] = 1;
  for (std::size_t k = 0; k < is_used.size(); ++k) {
    if (is_used[k] == 0) continue;
    const Material& material = surface.scene.materials[k];
    if (material.texture) part["textured"].push_back(material.name);
    // The look of a mirror depends on the place of the eye. A page without rays has one color for it.
    const bool is_mirror = material.specular_reflectance.size() > 0 &&
                           material.specular_reflectance.maxCoeff() > material.reflectance.maxCoeff();
    if (is_mirror) part["mirrors"].push_back(k);
  }
}

// The solved surface as the page draws it: faces, colors and values, packed, with the names that go with them.
Json model_part(const SolvedSurface& surface, double exposure) {
  const std::size_t most_faces = 150'000;
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
  part["values"] = values_part(surface, drawn);
  return part;
}

Json diagnostics_part(const Diagnostics& diagnostics) {
  Json parts = json_of(diagnostics);
  for (std::size_t n = 0; n < diagnostics.size(); ++n) {
    const std::vector<ModelFace>& faces = diagnostics[n].faces;
    parts[n]["outlines"] = Json::array();
    for (std::size_t k = 0; k < std::min<std::size_t>(faces.size(), 200); ++k) {
      Json outline = Json::array();
      for (const Point& corner : faces[k].corners) outline.push_back(json_array(corner));
      parts[n]["outlines"].push_back(std::move(outline));
    }
  }
  return parts;
}

std::string caption_of(const Picture& picture) {
  std::string text = picture.camera.name.empty() ? "" : picture.camera.name + ": ";
  text += picture.brightest ? "luminance in false colors, 0 to " + rounded(*picture.brightest) + " cd/m\u00b2"
                            : "natural colors";
  return picture.unfinished ? text + ", preliminary: the rendering was stopped early" : text;
}

Json picture_part(const Picture& picture) {
  const DisplayImage image =
      picture.brightest ? with_legend(picture.image, 0, *picture.brightest, "luminance, cd/m^2") : picture.image;
  Json part;
  part["caption"] = caption_of(picture);
  part["png"] = base64(png_bytes(image));
  part["width"] = image.width;
  part["height"] = image.height;
  const Camera& camera = picture.camera;
  part["camera"] = {{"eye", json_array(camera.eye)},
                    {"target", json_array(camera.target)},
                    {"vertical_field_of_view", camera.vertical_field_of_view},
                    {"projection", name_of(camera.projection)}};
  return part;
}

// That of the first picture as it looks: the model is then as bright as the picture is.
double exposure_of(const Page& page) {
  const auto looks = [](const Picture* picture) { return !picture->brightest; };
  const auto first = std::find_if(page.pictures.begin(), page.pictures.end(), looks);
  return first == page.pictures.end() ? page.provenance.exposure : (*first)->exposure;
}

Json data_of(const Page& page) {
  Json data;
  data["version"] = version();
  data["command_line"] = page.provenance.command_line;
  data["changes"] = page.provenance.changes;
  data["scene_hash"] = page.provenance.scene_hash;
  data["file"] = page.scene.file;
  data["files"] = page.scene.files;
  data["sha256"] = page.scene.sha256;
  data["diagnostics"] = diagnostics_part(page.scene.diagnostics);
  if (page.report != nullptr) data["report"] = report_json(*page.report, page.provenance);
  if (page.readings != nullptr) data["sensors"] = sensor_maps(page.scene, *page.readings);
  data["pictures"] = Json::array();
  for (const Picture* picture : page.pictures) data["pictures"].push_back(picture_part(*picture));
  if (page.comparison != nullptr) data["comparison"] = comparison_json(page.scene, *page.comparison, page.provenance);
  if (page.study != nullptr) data["study"] = study_json(page.scene, *page.study, page.provenance);
  if (page.surface != nullptr) data["model"] = model_part(*page.surface, exposure_of(page));
  if (page.surface != nullptr) data["three"] = packed_text(page_scripts(), 1);
  return data;
}

// JSON in HTML: without "<" nothing in it can end the element that it stands in, or open another. Names from a model
// may hold bytes that are not UTF-8: they are replaced.
std::string json_in_html(const Json& json) {
  return replaced(json.dump(-1, ' ', false, Json::error_handler_t::replace), {{'<', "\\u003c"}});
}

std::string text_in_html(const std::string& text) {
  const std::string valid = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return replaced(Json::parse(valid).get<std::string>(),
                  {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}});
}

}  // namespace

std::string page_of(const Page& page) {
  const std::string title = std::filesystem::path(page.scene.file).filename().string() + " \u00b7 patchlight";
  const std::string_view whole = page_template();
  constexpr std::string_view title_mark = "@TITLE@", data_mark = "@DATA@";
  const std::size_t title_at = whole.find(title_mark), data_at = whole.find(data_mark);
  const std::size_t after_title = title_at + title_mark.size();
  std::string html(whole.substr(0, title_at));
  html += text_in_html(title);
  html += whole.substr(after_title, data_at - after_title);
  html += json_in_html(data_of(page));
  html += whole.substr(data_at + data_mark.size());
  return html;
}

void write_page(const std::filesystem::path& file, const Page& page) { write_bytes(file, page_of(page)); }

}  // namespace patchlight
