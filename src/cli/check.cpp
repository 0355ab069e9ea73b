#include "base/parallel.h"
#include "base/words.h"
#include "cli/commands.h"
#include "cli/distinct_files.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "cli/output_options.h"
#include "cli/progress.h"
#include "cli/render.h"
#include "cli/summary.h"
#include "mesh/nested_mesh.h"
#include "output/file/whole_file.h"
#include "output/report/write_checks.h"
#include "output/vtk/write_vtk.h"
#include "pipeline/expected_cost.h"
#include "pipeline/first_mesh.h"
#include "pipeline/local_cuts.h"
#include "plan/check_request.h"
#include "plan/choose_storage.h"
#include "plan/survey.h"
#include "scene/model_face.h"
#include "scene/sensor_grid.h"

#include <algorithm>
#include <array>
#include <iomanip>
#include <iostream>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

// Significant digits of lengths and areas.
constexpr int digits = 4;

// "and 171 more (--all lists them)"; empty if all are shown.
std::string rest_line(std::size_t count, std::size_t shown) {
  if (count <= shown) return {};
  return "  and " + std::to_string(count - shown) + " more (--all lists them)\n";
}

std::string listed_numbers(const auto& values, const std::string& separator = ", ") {
  return listed_as(
      values, [](double value) { return rounded(value, digits); }, separator);
}

std::string size_line(const Scene& scene, const SceneReport& report) {
  return "size: " + listed_numbers(Vector(report.bounds.sizes()), " x ") + " m, from (" +
         listed_numbers(report.bounds.min()) + ") to (" + listed_numbers(report.bounds.max()) +
         "), one model unit being " + rounded(scene.metres_per_unit, digits) + " m\n";
}

std::string counts_lines(const SceneReport& report, std::size_t faces) {
  std::ostringstream text;
  text << "faces: " << faces << ", as " << counted(report.polygons, "polygon") << " of " << rounded(report.area, digits)
       << " m^2, " << report.vertices << " vertices, " << counted(report.groups, "group") << '\n';
  text << "shells: " << report.shells << ", of these " << report.closed_shells << " closed; ";
  if (report.open_edges == 0) {
    text << "no open edges\n";
  } else {
    text << counted(report.open_edges, "open edge") << ", " << rounded(report.open_edge_length, digits)
         << " m in all\n";
  }
  return text.str();
}

std::string sides_lines(const SceneReport& report) {
  if (!report.sides) return {};
  std::ostringstream text;
  text << "sides (" << name_of(report.sides->chosen) << "): " << report.sides->kept << " of " << 2 * report.polygons
       << " take part, " << rounded(report.sides->area, digits) << " m^2\n";
  for (const Diagnostic& note : report.sides->notes)
    text << "  note: " << name_of(note.code) << ": " << shown_name(note.text) << '\n';
  return text.str();
}

// "; specular reflectance 0.9, 0.9, 0.9" for a mirror; empty for others.
std::string part(const char* name, const Spectrum& values) {
  if (!(values > 0).any()) return {};
  return std::string("; ") + name + ' ' + listed_numbers(values);
}

// The width of a column with these names, at most 40 characters.
std::size_t width_of(const std::vector<std::string>& names) {
  std::size_t width = 0;
  for (const std::string& name : names) width = std::max(width, shown_name(name).size());
  return std::min<std::size_t>(width, 40);
}

// Largest first. Without --all the lists of materials, objects, rooms and problems fit on one screen.
std::string material_lines(const SceneReport& report, bool all) {
  std::vector<MaterialFacts> materials = report.materials;
  if (!all && materials.size() > 12) {
    std::stable_sort(materials.begin(), materials.end(),
                     [](const MaterialFacts& a, const MaterialFacts& b) { return a.area > b.area; });
    materials.resize(12);
  }
  std::vector<std::string> names;
  for (const MaterialFacts& facts : materials) names.push_back(facts.material.name);
  std::ostringstream text;
  text << "materials: " << report.materials.size() << '\n';
  for (const MaterialFacts& facts : materials) {
    text << "  " << std::left << std::setw(static_cast<int>(width_of(names))) << shown_name(facts.material.name)
         << "  reflectance " << listed_numbers(facts.material.reflectance)
         << part("specular reflectance", facts.material.specular_reflectance)
         << part("transmittance", facts.material.transmittance)
         << ((facts.material.transmittance > 0).any() ? ", index " + rounded(facts.material.index, digits) : "")
         << part("diffuse transmittance", facts.material.diffuse_transmittance) << "; " << counted(facts.faces, "face")
         << ", " << rounded(facts.area, digits) << " m^2\n";
  }
  return text.str() + rest_line(report.materials.size(), materials.size());
}

// The largest objects or groups, as accepted by --only and --exclude. For IFC, classes with a pattern for each.
std::string object_lines(const SceneReport& report, bool all) {
  const std::vector<ObjectFacts>& objects = all ? report.objects : report.classes;
  if (objects.size() < 2) return {};
  const std::size_t shown = all ? objects.size() : std::min<std::size_t>(objects.size(), 6);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < shown; ++k) names.push_back(objects[k].name);
  std::ostringstream text;
  text << "objects: " << report.objects.size() << '\n';
  for (std::size_t k = 0; k < shown; ++k) {
    text << "  " << std::left << std::setw(static_cast<int>(width_of(names))) << shown_name(objects[k].name) << "  ";
    if (objects[k].objects > 1) text << objects[k].objects << " objects, ";
    text << counted(objects[k].faces, "face") << ", " << rounded(objects[k].area, digits) << " m^2\n";
  }
  return text.str() + rest_line(objects.size(), shown);
}

// Largest first.
std::string room_lines(const Scene& scene, bool all) {
  if (scene.rooms.empty()) return {};
  std::vector<std::pair<double, const NamedRoom*>> rooms;
  std::set<std::string> storeys;
  for (const NamedRoom& room : scene.rooms) {
    rooms.emplace_back(area_of(floor_of_room(room.faces, scene.up)), &room);
    if (!room.storey.empty()) storeys.insert(room.storey);
  }
  std::stable_sort(rooms.begin(), rooms.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  const std::size_t shown = all ? rooms.size() : std::min<std::size_t>(rooms.size(), 6);
  std::string text = "rooms: " + std::to_string(rooms.size());
  if (!storeys.empty()) text += " on " + counted(storeys.size(), "storey");
  for (std::size_t k = 0; k < shown; ++k) {
    const auto& [area, room] = rooms[k];
    text += (k == 0 ? ": " : "; ") + shown_name(room->name);
    if (!room->storey.empty()) text += " (" + shown_name(room->storey) + ")";
    text += " " + rounded(area, 3) + " m^2";
  }
  if (rooms.size() > shown) text += "; and " + std::to_string(rooms.size() - shown) + " more (--all lists them)";
  return text + '\n';
}

std::string lamp_lines(const SceneReport& report, std::size_t luminaires) {
  std::ostringstream text;
  text << "lamps: " << (report.lamps == 0 ? "none" : counted(report.lamps, "face"));
  if (luminaires > 0) text << ", and " << counted(luminaires, "luminaire");
  text << '\n';
  for (const MaterialFacts& facts : report.materials) {
    if (!(facts.material.exitance > 0).any()) continue;
    text << "  " << shown_name(facts.material.name) << "  flux " << listed_numbers(facts.flux) << " W, "
         << rounded(facts.luminous_flux, digits) << " lm from " << rounded(facts.area, digits) << " m^2\n";
  }
  return text.str();
}

std::string daylight_lines(const Scene& scene) {
  std::ostringstream text;
  if (scene.sun) {
    text << "sun: " << listed_numbers(scene.sun->normal_irradiance) << " W/m^2 direct normal, from ("
         << listed_numbers(scene.sun->direction) << ")\n";
  }
  if (!scene.sky) return text.str();
  const Sky& sky = *scene.sky;
  text << "sky: " << name_of(sky.kind) << ", ";
  if (sky.horizontal_irradiance.size() > 0) {
    text << listed_numbers(sky.horizontal_irradiance) << " W/m^2 horizontal, under the open sky\n";
  } else {
    text << listed_numbers(sky.zenith_radiance) << " W/(m^2 sr) from the zenith\n";
  }
  const bool is_black = !(sky.ground_radiance > 0).any();
  text << "ground: " << (is_black ? "black" : listed_numbers(sky.ground_radiance) + " W/(m^2 sr)") << '\n';
  return text.str();
}

// A message of the library, with hints on separate lines.
std::string with_hints(const std::string& text) {
  const std::string mark = "\nhint: ";
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return shown_name(with_option_names(text));
  return with_hints(text.substr(0, at)) + "\n    hint: " + with_hints(text.substr(at + mark.size()));
}

std::string problem_lines(const SceneReport& report, bool all) {
  std::array<std::size_t, 4> count{};
  std::vector<std::string> lines;
  for (const Diagnostic& found : report.diagnostics) {
    ++count[static_cast<std::size_t>(severity_of(found.code))];
    lines.push_back(std::string(name_of(severity_of(found.code))) + ": " + name_of(found.code) + ": " +
                    with_hints(found.text));
  }
  std::string text = "problems: " + counted(count[0], "error") + ", " + counted(count[1], "warning") + ", " +
                     counted(count[2], "remark") + '\n';
  const std::size_t shown = all ? lines.size() : std::min<std::size_t>(lines.size(), 10);
  for (std::size_t k = 0; k < shown; ++k) text += "  " + lines[k] + '\n';
  return text + rest_line(lines.size(), shown);
}

const char* verdict(const SceneReport& report) {
  if (!report.usable) return "has no light yet; can be solved once it has one";
  const bool has_errors =
      std::any_of(report.diagnostics.begin(), report.diagnostics.end(),
                  [](const Diagnostic& problem) { return severity_of(problem.code) == Severity::error; });
  return has_errors ? "can be solved, but parts are lost: see the errors" : "can be solved";
}

// The command for the next step.
std::string next_line(const CheckArguments& arguments, const SceneReport& report, bool needs_sensors) {
  if (arguments.models.front() == "-") return {};
  std::string models;
  for (const std::filesystem::path& file : arguments.models) models += " " + shell_word(shown_name(file.string()));
  const ReadOptions& read = arguments.read;
  const bool has_more = read.metres_per_unit || read.up || !read.settings.empty() || !read.only.empty() ||
                        !read.leave_out.empty() || read.detail > 0 || read.keep_faces || !read.format.empty();
  const std::string result = arguments.models.front().stem().string();
  const std::string setting = report.first_light ? report.first_light->setting : "";
  const std::string command = needs_sensors || (report.first_light && setting.empty())
                                  ? "init" + models + " -o " + shell_word(result + ".toml")
                                  : "solve" + models +
                                        (setting.empty() ? "" : " " + shown_name(with_option_names(setting))) + " -o " +
                                        shell_word(result + ".vtp") + " --picture " + shell_word(result + ".png");
  return "next: patchlight " + command + (has_more ? " and the options given here" : "") + '\n';
}

// Renders from the requested camera, else the first of the scene, if any.
void write_model_picture(const CheckArguments& arguments, const Scene& scene) {
  const double distance = arguments.ambient_distance.value_or(bounds(scene).sizes().mean() / 10);
  const PictureOptions options{.camera = camera_for(arguments.picture, scene),
                               .width = arguments.picture.size[0],
                               .height = arguments.picture.size[1]};
  write_picture_file(arguments.picture.file, ambient_picture(scene, options, distance), scene);
}

const char* word_for(const Decision& decision) {
  if (decision.forced) return decision.simulate ? "on, by force" : "off, by force";
  return decision.simulate ? "on" : "off";
}

// True for effects that select the simulated surfaces, rather than a property of light.
bool is_of_surfaces(Effect effect) { return effect == Effect::reach || effect == Effect::backs; }

// Two lines per effect: the deciding fact, and the cost or saving.
std::string lines_of(const std::vector<Decision>& decisions, bool of_surfaces) {
  std::ostringstream text;
  for (const Decision& decision : decisions) {
    if (is_of_surfaces(decision.effect) != of_surfaces) continue;
    text << std::left << std::setw(17) << name_of(decision.effect) << word_for(decision) << ": "
         << with_option_names(decision.reason) << '\n'
         << std::setw(17) << "" << (decision.simulate ? "takes: " : "saves: ") << decision.saving << '\n';
  }
  return text.str();
}

std::string cost_lines(const ExpectedCost& cost) {
  const std::string first = cost.of_first_mesh ? "patches and shadow rays are chosen while solving; the first mesh "
                                                 "alone is expected to take "
                                               : "expected: ";
  return first + std::to_string(cost.patches) + " patches, " + rounded(cost.bytes / 1e9, 2) + " GB, about " +
         rounded(cost.seconds(), 2) + " s on " + std::to_string(cost.threads) +
         (cost.threads == 1 ? " thread" : " threads") + " (an estimate, right to a factor of two or so)\n" +
         "processor seconds: form factors " + rounded(cost.form_factor_seconds, 2) + ", direct light " +
         rounded(cost.direct_light_seconds, 2) + ", closure and solution " + rounded(cost.solve_seconds, 2) + '\n';
}

// Costs outside the estimate.
std::string further_costs(const Plan& plan, const ExpectedCost& cost) {
  const auto patches = static_cast<PatchIndex>(cost.patches);
  const bool has_second_mesh = makes_second_mesh(plan, patches) && fits_as_next_mesh(patches, 1, plan);
  const std::string sensors = cost.sensors == 0
                                  ? ""
                                  : counted(cost.sensors, "sensor") + " of about " + rounded(cost.sensor_seconds, 2) +
                                        (cost.of_first_mesh ? " processor seconds or more, " : " processor seconds, ");
  return std::string("in addition: ") + (has_error_bars(plan.accuracy) ? "error bars, " : "") +
         (has_second_mesh ? "a second mesh if the error of the first is above 2 %, " : "") + sensors +
         "requested images and pages" +
         (plan.accuracy.seconds ? "; --time-limit does not include sensors and images" : "") + "\n";
}

}  // namespace

ExitCode run(const CheckArguments& arguments) {
  for (const OutputFile& output : outputs_of(arguments))
    if (!output.file.empty()) check_writable(output.file);
  const Scene scene = with_option_names(read_scene(arguments.models, arguments.read));
  require_not_read(outputs_of(arguments), scene.inputs);
  SceneReport report = survey(scene);
  report.diagnostics = with_option_names(std::move(report.diagnostics));
  if (arguments.sides) report.sides = count_sides(scene, *arguments.sides);

  const WritingGuard guard;
  if (!arguments.json.empty()) write_bytes(arguments.json, survey_json(scene, report));
  if (!arguments.problems.empty()) write_problems(arguments.problems, scene, report);
  if (!arguments.picture.file.empty()) write_model_picture(arguments, scene);
  if (arguments.json_on_stdout) {
    std::cout << survey_json(scene, report) << std::flush;
  } else {
    std::cout << shown_name(scene.file) << ": " << verdict(report) << '\n'
              << next_line(arguments, report, !scene.rooms.empty() && scene.sensors.empty()) << size_line(scene, report)
              << counts_lines(report, scene.faces) << sides_lines(report) << room_lines(scene, arguments.all)
              << object_lines(report, arguments.all) << material_lines(report, arguments.all)
              << lamp_lines(report, scene.luminaires.size()) << daylight_lines(scene)
              << problem_lines(report, arguments.all) << std::flush;
  }
  if (!report.usable) print_message("note", scene.file + ": no light source: " + report.first_light->advice);
  return good;
}

ExitCode run(const PlanArguments& arguments) {
  if (!arguments.json.empty()) check_writable(arguments.json);
  const ThreadLimit limit(arguments.request.resources.threads);
  const Scene scene = with_option_names(read_scene(arguments.models, arguments.read));
  print_scene_warnings(scene);
  require_not_read({{"--json", arguments.json}}, scene.inputs);
  check(arguments.request, scene);
  const Plan planned = make_plan(scene, arguments.request);
  require_memory(scene, arguments.request, planned);
  const NestedMesh mesh = first_mesh(scene, planned);
  require_memory(mesh.patches.size(), arguments.request, planned);
  const Plan plan = with_option_names(with_note_on_second_mesh(planned, mesh.patches.size()));
  const ExpectedCost cost = expected_cost(scene, plan, mesh.patches);

  const WritingGuard guard;
  if (!arguments.json.empty()) write_bytes(arguments.json, plan_json(scene, plan, cost));
  print_notes(merged({remarks_of(scene), plan.sides.notes, plan.notes}), false);
  std::cout << shown_name(scene.file) << ": " << scene.polygons.size() << " polygons\n"
            << "effects of light\n"
            << lines_of(plan.decisions, false) << "sides of surfaces that no light reaches (on: simulated)\n"
            << lines_of(plan.decisions, true) << cost_lines(cost) << further_costs(plan, cost) << std::flush;
  return good;
}

}  // namespace patchlight::cli
