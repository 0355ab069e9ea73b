#include "output/vtk/write_vtk.h"

#include "patchlight/base/error.h"

#include "light/photometry.h"
#include "render/render.h"
#include "render/tone_map.h"
#include "temporary_folder.h"
#include "tiny_simulation.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetAttributes.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkVariant.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

namespace patchlight::write_vtk_test {
namespace {

constexpr double exposure = 0.125;

vtkSmartPointer<vtkPolyData> read(const std::string& file) {
  const vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

vtkSmartPointer<vtkPolyData> written_and_read(const Scene& scene, const Simulation& simulation) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "result.vtp";
  const Simulation in = in_scene(simulation, scene);
  write_vtk(file, surface_of(in), {"patchlight solve tiny.obj", exposure});
  EXPECT_EQ(folder.entries(), 1U);
  return read(file);
}

void expect_floats(vtkDataArray* array, const FieldView& values) {
  ASSERT_NE(array, nullptr);
  EXPECT_EQ(array->GetDataType(), VTK_FLOAT);
  ASSERT_EQ(array->GetNumberOfComponents(), values.cols());
  ASSERT_EQ(array->GetNumberOfTuples(), values.rows());
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    for (int band = 0; band < values.cols(); ++band) {
      EXPECT_EQ(array->GetComponent(row, band), static_cast<float>(values(row, band))) << array->GetName();
    }
  }
}

std::string text(vtkPolyData* polygons, const char* name, int entry = 0) {
  auto* const array = vtkStringArray::SafeDownCast(polygons->GetFieldData()->GetAbstractArray(name));
  return array != nullptr && entry < array->GetNumberOfValues() ? array->GetValue(entry) : "none";
}

double number(vtkPolyData* polygons, const char* name, int entry = 0) {
  vtkDataArray* const array = polygons->GetFieldData()->GetArray(name);
  return array != nullptr && entry < array->GetNumberOfTuples() ? array->GetComponent(entry, 0) : -1;
}

TEST(WriteVtk, KeepsTrianglesAndQuadrilaterals) {
  const Simulation simulation = tiny_simulation();
  const auto polygons = written_and_read(tiny_scene(), simulation);
  ASSERT_EQ(polygons->GetNumberOfPoints(), 5);
  for (int k = 0; k < 5; ++k) {
    const Point point(polygons->GetPoint(k));
    EXPECT_EQ(point, simulation.mesh.vertices[static_cast<std::size_t>(k)]);
  }
  ASSERT_EQ(polygons->GetNumberOfCells(), 3);
  for (int cell = 0; cell < 3; ++cell) {
    const auto& corners = simulation.mesh.corners[static_cast<std::size_t>(cell)];
    ASSERT_EQ(polygons->GetCell(cell)->GetNumberOfPoints(), cell == 0 ? 4 : 3);
    for (int k = 0; k < polygons->GetCell(cell)->GetNumberOfPoints(); ++k) {
      EXPECT_EQ(polygons->GetCell(cell)->GetPointId(k), corners[static_cast<std::size_t>(k)]);
    }
  }
}

bool are_alike(vtkDataSetAttributes& a, vtkDataSetAttributes& b) {
  if (a.GetNumberOfArrays() != b.GetNumberOfArrays()) return false;
  for (int k = 0; k < a.GetNumberOfArrays(); ++k) {
    vtkDataArray* const first = a.GetArray(k);
    vtkDataArray* const second = b.GetArray(first->GetName());
    if (second == nullptr || first->GetDataType() != second->GetDataType()) return false;
    const vtkIdType count = first->GetNumberOfValues();
    if (second->GetNumberOfValues() != count) return false;
    for (vtkIdType v = 0; v < count; ++v) {
      if (first->GetVariantValue(v) != second->GetVariantValue(v)) return false;
    }
  }
  return true;
}

// A grid has the patches of the polygons, with all their values.
TEST(WriteVtk, AnUnstructuredGridHoldsTheSame) {
  const TemporaryFolder folder;
  for (const char* name : {"result.vtp", "result.vtu"})
    write_vtk(folder.path() / name, tiny_surface(), {"a command", exposure});
  const vtkSmartPointer<vtkPolyData> polygons = read(folder.path() / "result.vtp");
  const vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder.path() / "result.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid& grid = *reader->GetOutput();
  ASSERT_EQ(grid.GetNumberOfCells(), polygons->GetNumberOfCells());
  ASSERT_EQ(grid.GetNumberOfPoints(), polygons->GetNumberOfPoints());
  EXPECT_EQ(grid.GetCellType(0), VTK_QUAD);
  EXPECT_EQ(grid.GetCellType(1), VTK_TRIANGLE);
  for (vtkIdType k = 0; k < grid.GetNumberOfCells(); ++k) {
    vtkIdList& corners = *grid.GetCell(k)->GetPointIds();
    vtkIdList& expected = *polygons->GetCell(k)->GetPointIds();
    ASSERT_EQ(corners.GetNumberOfIds(), expected.GetNumberOfIds());
    for (vtkIdType c = 0; c < corners.GetNumberOfIds(); ++c) EXPECT_EQ(corners.GetId(c), expected.GetId(c));
  }
  EXPECT_GT(grid.GetCellData()->GetNumberOfArrays(), 10);
  EXPECT_TRUE(are_alike(*polygons->GetCellData(), *grid.GetCellData()));
  EXPECT_TRUE(are_alike(*polygons->GetPointData(), *grid.GetPointData()));
  EXPECT_EQ(grid.GetFieldData()->GetArray("exposure")->GetComponent(0, 0), exposure);
}

TEST(WriteVtk, LeavesOutRowSumsThatAreNotKnown) {
  Simulation simulation = tiny_simulation();
  simulation.transport.row_sum = simulation.transport.raw_row_sum = Eigen::VectorXd();
  const auto polygons = written_and_read(tiny_scene(), simulation);
  EXPECT_EQ(polygons->GetCellData()->GetArray("row_sum"), nullptr);
  EXPECT_EQ(polygons->GetCellData()->GetArray("raw_row_sum"), nullptr);
  EXPECT_NE(polygons->GetCellData()->GetArray("area"), nullptr);
}

// dL = rho dH / pi. The squares of the three parts add up to that of the total.
TEST(WriteVtk, ErrorBarsAreOfTheRadiance) {
  const Simulation simulation = tiny_simulation_with_bars();
  const auto polygons = written_and_read(tiny_scene(), simulation);
  vtkCellData* const cells = polygons->GetCellData();
  const ErrorBars& bars = *simulation.error_bars;
  const Field factor = simulation.problem.scattering.reflectance / std::numbers::pi;
  expect_floats(cells->GetArray("error_mesh"), factor * bars.mesh);
  expect_floats(cells->GetArray("error_form_factor"), factor * bars.form_factor);
  expect_floats(cells->GetArray("error_solver"), factor * bars.solver);
  expect_floats(cells->GetArray("display_error"), factor * bars.display);
  expect_floats(cells->GetArray("error_irradiance"), bars.total());
  for (int i = 0; i < 3; ++i) {
    for (int band = 0; band < 3; ++band) {
      const auto of = [&](const char* name) { return cells->GetArray(name)->GetComponent(i, band); };
      const double total = std::hypot(of("error_mesh"), of("error_form_factor"), of("error_solver"));
      EXPECT_NEAR(of("error_total") / total, 1, 2 * std::numeric_limits<float>::epsilon());
    }
  }
  EXPECT_EQ(number(polygons, "relative_error_mesh"), 0.03);
  EXPECT_EQ(number(polygons, "relative_error_form_factor"), 0.04);
  EXPECT_EQ(number(polygons, "relative_error_solver"), 0.001);
  EXPECT_EQ(number(polygons, "relative_error_total"), 0.05);
  EXPECT_EQ(number(polygons, "relative_display_error"), 0.25);
}

// Without bars, the bound of the solver, if there is one.
TEST(WriteVtk, TheSolversBoundStandsAlone) {
  Simulation simulation = tiny_simulation();
  const auto without = written_and_read(tiny_scene(), simulation);
  EXPECT_EQ(without->GetCellData()->GetArray("error_solver"), nullptr);
  simulation.solution.error = 1e-3 * simulation.solution.radiosity;
  const auto polygons = written_and_read(tiny_scene(), simulation);
  expect_floats(polygons->GetCellData()->GetArray("error_solver"), simulation.solution.error / std::numbers::pi);
  for (const char* name : {"error_mesh", "error_form_factor", "error_total", "display_error", "error_irradiance"}) {
    EXPECT_EQ(polygons->GetCellData()->GetArray(name), nullptr) << name;
  }
  EXPECT_EQ(number(polygons, "relative_error_total"), -1);
}

TEST(WriteVtk, WithLightsThatAreNoPatchesTheirErrorIsThere) {
  Simulation simulation = tiny_simulation();
  EXPECT_EQ(written_and_read(tiny_scene(), simulation)->GetCellData()->GetArray("error_direct_irradiance"), nullptr);
  simulation.direct_standard_error = 0.01 * simulation.solution.direct_irradiance;
  const auto polygons = written_and_read(tiny_scene(), simulation);
  expect_floats(polygons->GetCellData()->GetArray("error_direct_irradiance"), simulation.direct_standard_error);
}

TEST(WriteVtk, ValuesComeBackAsFloats) {
  const Simulation simulation = tiny_simulation();
  const auto polygons = written_and_read(tiny_scene(), simulation);
  vtkCellData* const cells = polygons->GetCellData();
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;
  Field luminances(3, 1);
  for (int i = 0; i < 3; ++i) luminances(i, 0) = luminance(radiance.row(i));
  expect_floats(cells->GetArray("radiance"), radiance);
  expect_floats(cells->GetArray("radiosity"), simulation.solution.radiosity);
  expect_floats(cells->GetArray("irradiance"), simulation.solution.irradiance);
  expect_floats(cells->GetArray("direct_irradiance"), simulation.solution.direct_irradiance);
  expect_floats(cells->GetArray("indirect_irradiance"), 0.75 * simulation.solution.irradiance);
  expect_floats(cells->GetArray("exitance"), simulation.problem.exitance);
  expect_floats(cells->GetArray("reflectance"), simulation.problem.scattering.reflectance);
  expect_floats(cells->GetArray("luminance"), luminances);
  expect_floats(cells->GetArray("area"), simulation.problem.area);
  expect_floats(cells->GetArray("row_sum"), simulation.transport.row_sum);
  expect_floats(cells->GetArray("raw_row_sum"), simulation.transport.raw_row_sum);
  const Field at_vertices =
      smooth(simulation.mesh, radiance, simulation.problem.area, Occluder(tiny_scene())).at_vertices;
  expect_floats(polygons->GetPointData()->GetArray("radiance_smooth"), at_vertices);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(cells->GetArray("material_id")->GetComponent(i, 0), i == 0 ? 0 : 1);
    EXPECT_EQ(cells->GetArray("source_polygon")->GetComponent(i, 0), 10 + i);
  }
  const auto expect_colours = [&](vtkDataArray* rgb, const Field& radiances) {
    const auto colours = tone_map(radiances, exposure, usual_bands(3));
    ASSERT_EQ(rgb->GetDataType(), VTK_UNSIGNED_CHAR);
    ASSERT_EQ(rgb->GetNumberOfTuples(), radiances.rows());
    for (int i = 0; i < rgb->GetNumberOfTuples(); ++i) {
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(rgb->GetComponent(i, c), colours[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)]);
    }
  };
  expect_colours(cells->GetArray("rgb"), radiance);
  expect_colours(polygons->GetPointData()->GetArray("rgb_smooth"), at_vertices);
}

TEST(WriteVtk, TellsWhereItComesFrom) {
  const auto polygons = written_and_read(tiny_scene(), tiny_simulation());
  EXPECT_EQ(text(polygons, "material_names", 1), "lamp");
  EXPECT_EQ(text(polygons, "version"), std::string("patchlight ") + version());
  EXPECT_EQ(text(polygons, "command_line"), "patchlight solve tiny.obj");
  EXPECT_EQ(text(polygons, "input_file"), "tiny.obj");
  EXPECT_EQ(text(polygons, "sha256"), "00ff");
  EXPECT_EQ(text(polygons, "seed"), "1152921504606846977");
  EXPECT_EQ(text(polygons, "decisions"), "occlusion: disabled by option; a reason");
  EXPECT_EQ(number(polygons, "exposure"), exposure);
  ASSERT_NE(polygons->GetFieldData()->GetArray("up"), nullptr);
  EXPECT_EQ(Vector(polygons->GetFieldData()->GetArray("up")->GetTuple3(0)), Vector::UnitZ());
  EXPECT_EQ(number(polygons, "converged"), 1);
  EXPECT_EQ(number(polygons, "iteration", 1), 1);
  EXPECT_EQ(number(polygons, "iteration_relative_residual", 1), 1e-7);
  EXPECT_TRUE(std::isinf(number(polygons, "iteration_error_bound", 0)));
  EXPECT_EQ(number(polygons, "iteration_work", 1), 2);
  EXPECT_EQ(text(polygons, "stage", 1), "solve");
  EXPECT_EQ(number(polygons, "stage_seconds", 1), 0.25);
}

// A viewer calls unnamed components X, Y and Z.
TEST(WriteVtk, NamesTheComponentsOfColors) {
  const auto polygons = written_and_read(tiny_scene(), tiny_simulation());
  for (vtkDataArray* array :
       {polygons->GetCellData()->GetArray("radiance"), polygons->GetCellData()->GetArray("irradiance"),
        polygons->GetCellData()->GetArray("rgb"), polygons->GetPointData()->GetArray("radiance_smooth")}) {
    const std::array names = {"r", "g", "b"};
    for (int c = 0; c < 3; ++c) EXPECT_STREQ(array->GetComponentName(c), names[static_cast<std::size_t>(c)]);
  }
}

TEST(WriteVtk, EveryArrayOfValuesHasAUnit) {
  const auto polygons = written_and_read(tiny_scene(), tiny_simulation_with_bars());
  for (vtkFieldData* const data :
       {static_cast<vtkFieldData*>(polygons->GetCellData()), static_cast<vtkFieldData*>(polygons->GetPointData())}) {
    ASSERT_GT(data->GetNumberOfArrays(), 0);
    for (int k = 0; k < data->GetNumberOfArrays(); ++k) {
      const std::string unit = std::string("unit_") + data->GetArrayName(k);
      EXPECT_NE(text(polygons, unit.c_str()), "none") << unit;
    }
  }
}

TEST(WriteVtk, TakesBandsAsTheSceneStatesThem) {
  Scene scene = tiny_scene();
  scene.bands = {{"450 nm", 0.25, {0, 0, 1}}, {"570 nm", 0.75, {1, 1, 0}}};
  Simulation simulation = tiny_simulation();
  for (Material& material : scene.materials) {
    material.reflectance = material.reflectance.head(2).eval();
    material.exitance = material.exitance.head(2).eval();
  }
  for (Field* field :
       {&simulation.problem.scattering.reflectance, &simulation.problem.exitance, &simulation.solution.irradiance,
        &simulation.solution.direct_irradiance, &simulation.solution.radiosity}) {
    *field = field->leftCols(2).eval();
  }
  const auto polygons = written_and_read(scene, simulation);
  expect_floats(polygons->GetCellData()->GetArray("radiosity"), simulation.solution.radiosity);
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;
  const Field luminances = luminous_efficacy * (0.25 * radiance.col(0) + 0.75 * radiance.col(1));
  expect_floats(polygons->GetCellData()->GetArray("luminance"), luminances);
  EXPECT_STREQ(polygons->GetCellData()->GetArray("radiosity")->GetComponentName(1), "570 nm");
  EXPECT_EQ(polygons->GetCellData()->GetArray("rgb")->GetNumberOfComponents(), 3);
}

// For any number of bytes that fit, including all but the last.
TEST(WriteVtk, FullDiskIsAnErrorAndKeepsTheOldFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "result.vtp";
  write_vtk(file, tiny_surface(), {"", exposure});
  const std::string old = content_of(file);
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{100}, old.size() / 2, old.size() - 1}) {
    {
      const FullDisk disk(bytes);
      EXPECT_THROW(write_vtk(file, tiny_surface(), {"", exposure}), OutputError) << bytes;
    }
    EXPECT_EQ(content_of(file), old);
    EXPECT_EQ(folder.entries(), 1U);
  }
}

}  // namespace
}  // namespace patchlight::write_vtk_test
