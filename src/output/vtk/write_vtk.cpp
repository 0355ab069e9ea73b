#include "output/vtk/write_vtk.h"

#include "patchlight/base/error.h"

#include "light/photometry.h"
#include "output/file/whole_file.h"
#include "output/vtk/vtk_polygons.h"
#include "pipeline/world.h"
#include "render/tone_map.h"
#include "solve/scattering.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <set>
#include <sys/file.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>

namespace patchlight {
namespace {

// The unit of every array of values; docs/reference/outputs/vtp.md explains them.
constexpr std::array<std::array<const char*, 2>, 25> units_of_arrays = {
    {{"radiance", "W/(m^2 sr)"},
     {"radiosity", "W/m^2"},
     {"irradiance", "W/m^2"},
     {"direct_irradiance", "W/m^2"},
     {"indirect_irradiance", "W/m^2"},
     {"exitance", "W/m^2"},
     {"reflectance", "1"},
     {"luminance", "cd/m^2"},
     {"area", "m^2"},
     {"material_id", "index into material_names"},
     {"source_polygon", "number of the face in the model's files, from 0"},
     {"polygon", "number of the polygon in the scene as it was solved, from 0"},
     {"side", "0 its front, 1 its back"},
     {"row_sum", "1"},
     {"raw_row_sum", "1"},
     {"rgb", "sRGB, 8 bits, at the recorded exposure"},
     {"error_mesh", "W/(m^2 sr)"},
     {"error_form_factor", "W/(m^2 sr)"},
     {"error_solver", "W/(m^2 sr)"},
     {"error_total", "W/(m^2 sr)"},
     {"display_error", "W/(m^2 sr)"},
     {"error_irradiance", "W/m^2"},
     {"error_direct_irradiance", "W/m^2"},
     {"radiance_smooth", "W/(m^2 sr)"},
     {"rgb_smooth", "sRGB, 8 bits, at the recorded exposure"}}};

// How far the radiance may be off, by where it comes from; of the solver alone where that is all that is known.
void add_errors(vtkCellData& cell_data, const Simulation& simulation) {
  // dL = R dH / pi
  const auto scattered = [&](const Field& irradiance) -> Field {
    return reflected_error(simulation.problem.scattering, irradiance) / std::numbers::pi;
  };
  const Field& of_lights = simulation.direct_standard_error;
  if (of_lights.size() > 0) cell_data.AddArray(floats("error_direct_irradiance", of_lights));
  if (!simulation.error_bars) {
    const Field& of_solver = simulation.solution.error;
    if (of_solver.size() > 0) cell_data.AddArray(floats("error_solver", of_solver / std::numbers::pi));
    const Field& of_rays = simulation.ray_standard_error;
    if (of_rays.size() > 0) cell_data.AddArray(floats("error_form_factor", scattered(of_rays)));
    return;
  }
  const ErrorBars& bars = *simulation.error_bars;
  const Field total = bars.total();
  cell_data.AddArray(floats("error_mesh", scattered(bars.mesh)));
  cell_data.AddArray(floats("error_form_factor", scattered(bars.form_factor)));
  cell_data.AddArray(floats("error_solver", scattered(bars.solver)));
  cell_data.AddArray(floats("error_total", scattered(total)));
  cell_data.AddArray(floats("display_error", scattered(bars.display)));
  cell_data.AddArray(floats("error_irradiance", total));
}

// Where bands are of wavelengths: of linear RGB they are the same once more.
void add_colours(vtkCellData& cell_data, const Field& radiance, const Bands& bands) {
  if (!are_of_wavelengths(bands)) return;
  const Field xyz = xyz_rows(radiance, bands);
  cell_data.AddArray(floats("xyz", xyz));
  cell_data.AddArray(numbers<vtkFloatArray>("cct", colour_temperatures(xyz)));
}

// Which wavelengths the components of spectra are of.
void add_bands(vtkFieldData& facts, const Bands& bands) {
  if (!are_of_wavelengths(bands)) return;
  std::vector<std::string> names;
  for (const Band& band : bands) names.push_back(band.name);
  facts.AddArray(strings("band_names", names));
  facts.AddArray(strings("white_of_rgb", {"D65, without adaptation"}));
  facts.AddArray(strings("unit_xyz", {"X, Y, Z of the CIE 1931 observer, cd/m^2"}));
  facts.AddArray(strings("unit_cct", {"K, not a number where it has no meaning"}));
}

void add_values(vtkPolyData& polygons, const SolvedSurface& surface, double exposure) {
  const Simulation& simulation = surface.simulation;
  const PatchMesh& mesh = simulation.mesh;
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;  // L = B / pi
  const Bands bands = bands_of(surface.scene);
  Field luminances(radiance.rows(), 1);
  for (Eigen::Index row = 0; row < radiance.rows(); ++row) luminances(row, 0) = luminance(radiance.row(row), bands);

  vtkCellData& cell_data = *polygons.GetCellData();
  cell_data.AddArray(floats("radiance", radiance));
  cell_data.AddArray(floats("radiosity", simulation.solution.radiosity));
  const Field& H = simulation.solution.irradiance;
  const Field& H_direct = simulation.solution.direct_irradiance;
  cell_data.AddArray(floats("irradiance", H));
  cell_data.AddArray(floats("direct_irradiance", H_direct));
  // Rounding may make the difference slightly negative.
  cell_data.AddArray(floats("indirect_irradiance", (H - H_direct).max(0.0)));
  add_errors(cell_data, simulation);
  cell_data.AddArray(floats("exitance", simulation.problem.exitance));
  cell_data.AddArray(floats("reflectance", simulation.problem.scattering.reflectance));
  cell_data.AddArray(floats("luminance", luminances));
  add_colours(cell_data, radiance, bands);
  cell_data.AddArray(numbers<vtkFloatArray>("area", mesh.area));
  cell_data.AddArray(numbers<vtkIntArray>("material_id", mesh.material));
  std::vector<std::uint32_t> faces;
  for (const PolygonIndex polygon : mesh.polygon) faces.push_back(surface.scene.polygons[polygon].face);
  cell_data.AddArray(numbers<vtkIntArray>("source_polygon", faces));
  cell_data.AddArray(numbers<vtkIntArray>("polygon", mesh.polygon));
  cell_data.AddArray(numbers<vtkIntArray>("side", mesh.side));
  // Not known of rows on demand. An array of another length than the others makes the file one that cannot be read.
  const auto add_known = [&](const char* name, const Eigen::VectorXd& values) {
    if (values.size() == radiance.rows()) cell_data.AddArray(numbers<vtkFloatArray>(name, values));
  };
  add_known("row_sum", simulation.transport.row_sum);
  add_known("raw_row_sum", simulation.transport.raw_row_sum);
  add_known("ambient_occlusion", surface.ambient_occlusion);
  cell_data.AddArray(colours("rgb", tone_map(radiance, exposure, bands)));
  // Viewers show these first.
  cell_data.SetActiveScalars("luminance");
  vtkPointData& point_data = *polygons.GetPointData();
  point_data.AddArray(floats("radiance_smooth", surface.radiance_at_vertices));
  point_data.AddArray(colours("rgb_smooth", tone_map(surface.radiance_at_vertices, exposure, bands)));
  if (surface.ambient_occlusion_at_vertices.size() > 0)
    point_data.AddArray(numbers<vtkFloatArray>("ambient_occlusion", surface.ambient_occlusion_at_vertices));
  name_components(cell_data, bands);
  name_components(point_data, bands);
}

Pointer<vtkDoubleArray> up_of(const Scene& scene) {
  auto up = numbers<vtkDoubleArray>("up", scene.up);
  up->SetNumberOfComponents(3);
  return up;
}

template <class Value>
Pointer<vtkDoubleArray> column(const char* name, const std::vector<Iteration>& history, Value Iteration::*member) {
  auto array = Pointer<vtkDoubleArray>::New();
  array->SetName(name);
  for (const Iteration& iteration : history) array->InsertNextValue(static_cast<double>(iteration.*member));
  return array;
}

void add_history(vtkFieldData& facts, const Simulation& simulation) {
  const std::vector<Iteration>& history = simulation.solution.history;
  facts.AddArray(numbers<vtkIntArray>("converged", std::array{simulation.solution.converged ? 1 : 0}));
  facts.AddArray(numbers<vtkIntArray>("unfinished", std::array{simulation.unfinished ? 1 : 0}));
  facts.AddArray(column("iteration", history, &Iteration::number));
  facts.AddArray(column("iteration_relative_residual", history, &Iteration::relative_residual));
  facts.AddArray(column("iteration_error_bound", history, &Iteration::error_bound));
  facts.AddArray(column("iteration_seconds", history, &Iteration::seconds));
  facts.AddArray(column("iteration_work", history, &Iteration::work));

  if (!simulation.accuracy.empty()) {
    const AccuracyStep& errors = simulation.accuracy.back();
    facts.AddArray(numbers<vtkDoubleArray>("relative_error_mesh", std::array{errors.mesh}));
    facts.AddArray(numbers<vtkDoubleArray>("relative_error_form_factor", std::array{errors.form_factor}));
    facts.AddArray(numbers<vtkDoubleArray>("relative_error_solver", std::array{errors.solver}));
    facts.AddArray(numbers<vtkDoubleArray>("relative_error_total", std::array{errors.total}));
    facts.AddArray(numbers<vtkDoubleArray>("relative_display_error", std::array{errors.display}));
  }
  std::vector<std::string> stages;
  std::vector<double> seconds, cpu_seconds;
  for (const StageCost& cost : simulation.costs) {
    stages.emplace_back(name_of(cost.stage));
    seconds.push_back(cost.seconds);
    cpu_seconds.push_back(cost.cpu_seconds);
  }
  facts.AddArray(strings("stage", stages));
  facts.AddArray(numbers<vtkDoubleArray>("stage_seconds", seconds));
  facts.AddArray(numbers<vtkDoubleArray>("stage_cpu_seconds", cpu_seconds));
}

// read_vtk() takes these.
void add_what_pictures_need(vtkFieldData& facts, const Simulation& simulation, const Provenance& provenance) {
  facts.AddArray(strings("scene_hash", {provenance.scene_hash}));
  const bool follows = simulation.world && simulation.world->tracing().reflections() == Reflections::followed;
  facts.AddArray(numbers<vtkIntArray>("follows_reflections", std::array{follows ? 1 : 0}));
  std::vector<std::string> names;
  std::vector<int> simulated, forced;
  for (const Decision& decision : simulation.plan.decisions) {
    names.emplace_back(name_of(decision.effect));
    simulated.push_back(decision.simulate ? 1 : 0);
    forced.push_back(decision.forced ? 1 : 0);
  }
  facts.AddArray(strings("effects", names));
  facts.AddArray(numbers<vtkIntArray>("effects_simulated", simulated));
  facts.AddArray(numbers<vtkIntArray>("effects_forced", forced));
  std::vector<std::uint32_t> middles;
  for (const Middle& middle : simulation.mesh.middles) {
    for (const std::uint32_t vertex : {middle.vertex, middle.ends[0], middle.ends[1]}) middles.push_back(vertex);
  }
  facts.AddArray(numbers<vtkIntArray>("middles", middles));
}

void add_facts(vtkFieldData& facts, const Scene& scene, const Simulation& simulation, const Provenance& provenance) {
  std::vector<std::string> material_names;
  for (const Material& material : scene.materials) material_names.push_back(material.name);
  facts.AddArray(strings("material_names", material_names));
  facts.AddArray(strings("version", {std::string("patchlight ") + version()}));
  facts.AddArray(strings("command_line", {provenance.command_line}));
  facts.AddArray(strings("input_file", {scene.file}));
  facts.AddArray(strings("sha256", {scene.sha256}));
  std::vector<std::string> decisions;
  for (const Decision& decision : simulation.plan.decisions) decisions.push_back(sentence(decision));
  facts.AddArray(strings("decisions", decisions));
  facts.AddArray(strings("seed", {std::to_string(simulation.plan.assembly.seed)}));  // 64 bits do not fit a double
  facts.AddArray(numbers<vtkDoubleArray>("exposure", std::array{provenance.exposure}));
  facts.AddArray(up_of(scene));
  add_what_pictures_need(facts, simulation, provenance);
  add_bands(facts, bands_of(scene));
  // One array per unit: ParaView's information panel shows the value of a string array with one entry.
  for (const auto& [name, unit] : units_of_arrays) facts.AddArray(strings(std::string("unit_") + name, {unit}));
}

namespace fs = std::filesystem;

// FNV-1a (Fowler, Noll, Vo), 32 bits.
std::uint32_t hashed(std::uint32_t hash, const void* data, std::size_t size) {
  const auto* const bytes = static_cast<const std::uint8_t*>(data);
  for (std::size_t k = 0; k < size; ++k) hash = (hash ^ bytes[k]) * 16777619U;
  return hash;
}

// Tells one series from another: equal numbers get equal names.
std::string name_of_values(const Simulation& simulation, const std::vector<IterateIrradiance>& iterates,
                           const Provenance& provenance) {
  std::uint32_t hash = hashed(2166136261U, provenance.command_line.data(), provenance.command_line.size());
  hash = hashed(hash, &provenance.exposure, sizeof provenance.exposure);
  for (const Point& vertex : simulation.mesh.vertices) hash = hashed(hash, vertex.data(), 3 * sizeof(double));
  for (const Field* field : {&simulation.problem.scattering.reflectance, &simulation.problem.exitance}) {
    hash = hashed(hash, field->data(), static_cast<std::size_t>(field->size()) * sizeof(double));
  }
  for (const IterateIrradiance& iterate : iterates) {
    hash = hashed(hash, iterate.data(), static_cast<std::size_t>(iterate.size()) * sizeof(float));
  }
  char text[16];
  std::snprintf(text, sizeof text, "%08x", static_cast<unsigned>(hash));
  return text;
}

std::string file_name(const fs::path& pvd, std::size_t number, const std::string& values) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "_%04zu.", number);
  return pvd.stem().string() + digits + values + ".vtp";
}

// True for names that file_name() makes for this series, whatever the values.
bool is_of_series(const fs::path& pvd, const std::string& name) {
  const std::string stem = pvd.stem().string();
  static const std::regex rest("_[0-9]{4,}\\.[0-9a-f]{8}\\.vtp");
  return name.starts_with(stem) && std::regex_match(name.substr(stem.size()), rest);
}

// Files of a new series that the .pvd does not name yet: removed, last first, when the scope is left.
struct Unfinished {
  std::vector<fs::path> made;
  ~Unfinished() {
    std::error_code ignored;
    for (auto path = made.rbegin(); path != made.rend(); ++path) fs::remove(*path, ignored);
  }
};

void add_facts(vtkFieldData& facts, const Scene& scene, const Iteration& iteration, const Provenance& provenance) {
  facts.AddArray(numbers<vtkDoubleArray>("TimeValue", std::array{iteration.number}));
  facts.AddArray(numbers<vtkDoubleArray>("relative_residual", std::array{iteration.relative_residual}));
  facts.AddArray(numbers<vtkDoubleArray>("error_bound", std::array{iteration.error_bound}));
  facts.AddArray(numbers<vtkDoubleArray>("exposure", std::array{provenance.exposure}));
  facts.AddArray(strings("version", {std::string("patchlight ") + version()}));
  facts.AddArray(strings("command_line", {provenance.command_line}));
  facts.AddArray(up_of(scene));
  facts.AddArray(strings("unit_radiance", {"W/(m^2 sr)"}));
  facts.AddArray(strings("unit_irradiance", {"W/m^2"}));
  facts.AddArray(strings("unit_rgb", {"sRGB, 8 bits, at the recorded exposure"}));
}

// `colours_of` maps a radiance to colors.
template <typename ColoursOf>
void add_values(vtkCellData& cells, const RadiosityProblem& problem, const Field& irradiance,
                const ColoursOf& colours_of) {
  // B_k = E + rho o H_k, L_k = B_k / pi
  const Field radiance = radiosity_from(problem, irradiance) / std::numbers::pi;
  cells.AddArray(floats("radiance", radiance));
  cells.AddArray(floats("irradiance", irradiance));
  cells.AddArray(colours("rgb", colours_of(radiance)));
}

// XML holds UTF-8 without control characters, also where these are escaped.
bool is_xml_text(const std::string& text) {
  if (std::any_of(text.begin(), text.end(), [](char letter) { return static_cast<unsigned char>(letter) < 0x20; }))
    return false;
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

std::string xml(const std::string& text) {
  return replaced(text, {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&apos;"}});
}

std::string collection(const std::string& folder, const std::vector<std::string>& names,
                       const std::vector<Iteration>& history) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n"
      "  <Collection>\n";
  for (std::size_t k = 0; k < names.size(); ++k) {
    text += "    <DataSet timestep=\"" + std::to_string(history[k].number) + "\" part=\"0\" file=\"" +
            xml(folder + "/" + names[k]) + "\"/>\n";
  }
  return text + "  </Collection>\n</VTKFile>\n";
}

// Files of an older series that the .pvd no longer names.
void remove_older(const fs::path& pvd, const std::vector<std::string>& names) {
  const std::set<std::string> kept(names.begin(), names.end());
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(series_folder(pvd), ignored)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file(ignored) && is_of_series(pvd, name) && !kept.contains(name))
      fs::remove(entry.path(), ignored);
  }
}

// The folder of a series, which belongs to one run as long as this lives: of two runs at a time, the first would lose
// its files.
class LockedFolder {
 public:
  LockedFolder(const fs::path& folder, const Observer& observer) {
    while (!is_locked(folder)) {
      if (observer && !observer({.stage = Stage::write})) throw Canceled();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  ~LockedFolder() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  LockedFolder(const LockedFolder&) = delete;
  LockedFolder& operator=(const LockedFolder&) = delete;

  bool is_new() const { return is_new_; }

 private:
  bool is_locked(const fs::path& folder) {
    std::error_code error;
    is_new_ = fs::create_directory(folder, error) || is_new_;
    if (error) throw OutputError(folder.string(), "cannot be created: " + error.message());
    descriptor_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ < 0 && errno != ENOENT)
      throw OutputError(folder.string(),
                        "cannot be opened: " + std::error_code(errno, std::generic_category()).message());
    // A file system without locks: as if there were no other run.
    struct stat status {};
    const bool is_ours = descriptor_ >= 0 && (flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK);
    // Another run may have removed the folder in the meantime.
    if (is_ours && fstat(descriptor_, &status) == 0 && status.st_nlink > 0) return true;
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
    return false;
  }

  int descriptor_ = -1;
  bool is_new_ = false;
};

}  // namespace

void write_vtk(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance) {
  const Pointer<vtkPolyData> polygons = polygons_of(surface.simulation.mesh);
  add_values(*polygons, surface, provenance.exposure);
  add_facts(*polygons->GetFieldData(), surface.scene, surface.simulation, provenance);
  add_history(*polygons->GetFieldData(), surface.simulation);

  if (file.extension() == ".vtu") return write_grid(file, *polygons);
  write_polygons(file, *polygons);
}

fs::path series_folder(const fs::path& pvd) { return pvd.parent_path() / (pvd.stem().string() + "_series"); }

void check_series_writable(const fs::path& pvd) {
  check_writable(pvd);
  if (!is_xml_text(pvd.stem().string())) {
    throw OutputError(pvd.string(),
                      "the name is not UTF-8 or has control characters, and the .pvd file names its members by it; "
                      "expected another name");
  }
  const fs::path folder = series_folder(pvd);
  std::error_code error;
  if (!fs::exists(fs::symlink_status(folder, error))) return;
  if (!fs::is_directory(folder, error)) {
    throw OutputError(folder.string(), "is in the way; expected a folder for the files of the series, or nothing");
  }
  check_writable(folder / "trial.vtp");
}

void write_series(const fs::path& pvd, const Scene& scene, const Simulation& simulation,
                  const std::vector<IterateIrradiance>& iterates, const Provenance& provenance,
                  const Observer& observer, const PublishCollection& publish) {
  const std::vector<Iteration>& history = simulation.solution.history;
  assert(iterates.size() == history.size());
  const fs::path folder = series_folder(pvd);
  const std::string values = name_of_values(simulation, iterates, provenance);
  const auto exposed = [&, bands = bands_of(scene)](const Field& radiance) {
    return tone_map(radiance, provenance.exposure, bands);
  };

  // 1. The files, under names that only a series of equal values has.
  std::vector<std::string> names;
  const LockedFolder lock(folder, observer);
  Unfinished unfinished;
  if (lock.is_new()) unfinished.made.push_back(folder);
  for (std::size_t k = 0; k < iterates.size(); ++k) {
    const double fraction = static_cast<double>(k) / static_cast<double>(iterates.size());
    if (observer && !observer({.stage = Stage::write, .fraction = fraction})) throw Canceled();
    const Pointer<vtkPolyData> polygons = polygons_of(simulation.mesh);
    add_values(*polygons->GetCellData(), simulation.problem, iterates[k].cast<double>(), exposed);
    name_components(*polygons->GetCellData(), bands_of(scene));
    add_facts(*polygons->GetFieldData(), scene, history[k], provenance);
    names.push_back(file_name(pvd, k, values));
    if (!fs::exists(folder / names.back())) unfinished.made.push_back(folder / names.back());
    write_polygons(folder / names.back(), *polygons);
  }

  // 2. The .pvd: from now on the series is the new one.
  publish(collection(folder.filename().string(), names, history));
  unfinished.made.clear();

  // 3. Nothing names the older files any more.
  remove_older(pvd, names);
}

void write_series(const fs::path& pvd, const Scene& scene, const Simulation& simulation,
                  const std::vector<IterateIrradiance>& iterates, const Provenance& provenance,
                  const Observer& observer) {
  write_series(pvd, scene, simulation, iterates, provenance, observer,
               [&](const std::string& text) { write_bytes(pvd, text); });
}

}  // namespace patchlight
