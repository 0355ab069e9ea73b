#include "output/vtk/write_vtk.h"

#include "light/colour.h"
#include "light/photometry.h"
#include "output/vtk/vtk_polygons.h"
#include "pipeline/world.h"
#include "render/tone_map.h"
#include "solve/scattering.h"

#include <array>
#include <numbers>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>

namespace patchlight {
namespace {

// The unit of every array of values; docs/reference/outputs/vtp.md says what they mean.
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
  // What a viewer shows first.
  cell_data.SetActiveScalars("luminance");
  vtkPointData& point_data = *polygons.GetPointData();
  point_data.AddArray(floats("radiance_smooth", surface.radiance_at_vertices));
  point_data.AddArray(colours("rgb_smooth", tone_map(surface.radiance_at_vertices, exposure, bands)));
  if (surface.ambient_occlusion_at_vertices.size() > 0)
    point_data.AddArray(numbers<vtkFloatArray>("ambient_occlusion", surface.ambient_occlusion_at_vertices));
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
  const Pointer<vtkDoubleArray> up = numbers<vtkDoubleArray>("up", scene.up);
  up->SetNumberOfComponents(3);
  facts.AddArray(up);
  add_what_pictures_need(facts, simulation, provenance);
  add_bands(facts, bands_of(scene));
  // One array per unit: ParaView's information panel shows the value of a string array with one entry.
  for (const auto& [name, unit] : units_of_arrays) facts.AddArray(strings(std::string("unit_") + name, {unit}));
}

}  // namespace

void write_vtk(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance) {
  const Pointer<vtkPolyData> polygons = polygons_of(surface.simulation.mesh);
  add_values(*polygons, surface, provenance.exposure);
  add_facts(*polygons->GetFieldData(), surface.scene, surface.simulation, provenance);
  add_history(*polygons->GetFieldData(), surface.simulation);

  if (file.extension() == ".vtu") return write_grid(file, *polygons);
  write_polygons(file, *polygons);
}

}  // namespace patchlight
