#include "output/read_vtk.h"

#include "patchlight/base/error.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

namespace patchlight {
namespace {

[[noreturn]] void refuse_file(const std::filesystem::path& file, const std::string& found) {
  throw InputError(file.string(), found + "; expected a .vtp file that this version of patchlight solve has written");
}

// An array with one tuple per patch.
vtkDataArray& cell_array(vtkPolyData& polygons, const char* name, const std::filesystem::path& file) {
  vtkDataArray* const array = polygons.GetCellData()->GetArray(name);
  if (array == nullptr || array->GetNumberOfTuples() != polygons.GetNumberOfCells())
    refuse_file(file, std::string("there is no array '") + name + "' of its patches");
  return *array;
}

Field field_of(vtkDataArray& array) {
  Field values(array.GetNumberOfTuples(), array.GetNumberOfComponents());
  for (Eigen::Index row = 0; row < values.rows(); ++row)
    for (Eigen::Index band = 0; band < values.cols(); ++band)
      values(row, band) = array.GetComponent(row, static_cast<int>(band));
  return values;
}

std::vector<std::string> texts_of(vtkPolyData& polygons, const char* name, const std::filesystem::path& file) {
  auto* const array = vtkStringArray::SafeDownCast(polygons.GetFieldData()->GetAbstractArray(name));
  if (array == nullptr) refuse_file(file, std::string("there is no fact '") + name + "'");
  std::vector<std::string> texts;
  for (vtkIdType k = 0; k < array->GetNumberOfValues(); ++k) texts.push_back(array->GetValue(k));
  return texts;
}

std::vector<double> numbers_of(vtkPolyData& polygons, const char* name, const std::filesystem::path& file) {
  vtkDataArray* const array = polygons.GetFieldData()->GetArray(name);
  if (array == nullptr) refuse_file(file, std::string("there is no fact '") + name + "'");
  std::vector<double> numbers;
  for (vtkIdType k = 0; k < array->GetNumberOfTuples(); ++k)
    for (int c = 0; c < array->GetNumberOfComponents(); ++c) numbers.push_back(array->GetComponent(k, c));
  return numbers;
}

void add_patches(StoredSolution& to, vtkPolyData& polygons, const std::filesystem::path& file) {
  for (vtkIdType k = 0; k < polygons.GetNumberOfPoints(); ++k) {
    Point point;
    polygons.GetPoint(k, point.data());
    to.vertices.push_back(point);
  }
  const vtkNew<vtkIdList> corners;
  for (vtkIdType k = 0; k < polygons.GetNumberOfCells(); ++k) {
    polygons.GetCellPoints(k, corners);
    if (corners->GetNumberOfIds() != 3 && corners->GetNumberOfIds() != 4)
      refuse_file(file, "a patch has " + std::to_string(corners->GetNumberOfIds()) + " corners");
    const auto corner = [&](vtkIdType c) {
      return static_cast<std::uint32_t>(corners->GetId(std::min(c, corners->GetNumberOfIds() - 1)));
    };
    to.corners.push_back({corner(0), corner(1), corner(2), corner(3)});
  }
  vtkDataArray& polygon = cell_array(polygons, "polygon", file);
  vtkDataArray& side = cell_array(polygons, "side", file);
  for (vtkIdType k = 0; k < polygons.GetNumberOfCells(); ++k) {
    to.polygon.push_back(static_cast<PolygonIndex>(polygon.GetComponent(k, 0)));
    to.side.push_back(side.GetComponent(k, 0) == 0 ? Side::front : Side::back);
  }
}

void add_run(StoredSolution& to, vtkPolyData& polygons, const std::filesystem::path& file) {
  to.scene_hash = texts_of(polygons, "scene_hash", file).front();
  to.follows_reflections = numbers_of(polygons, "follows_reflections", file).front() != 0;
  to.converged = numbers_of(polygons, "converged", file).front() != 0;
  const std::string seed = texts_of(polygons, "seed", file).front();
  std::from_chars(seed.data(), seed.data() + seed.size(), to.seed);
  const std::vector<std::string> effects = texts_of(polygons, "effects", file);
  const std::vector<double> simulated = numbers_of(polygons, "effects_simulated", file);
  const std::vector<double> forced = numbers_of(polygons, "effects_forced", file);
  for (const Effect effect : simulated_effects()) {
    const auto place = std::find(effects.begin(), effects.end(), name_of(effect));
    const auto k = static_cast<std::size_t>(place - effects.begin());
    if (k < std::min({effects.size(), simulated.size(), forced.size()}))
      to.decisions.push_back({.effect = effect, .simulate = simulated[k] != 0, .forced = forced[k] != 0});
  }
  const std::vector<double> middles = numbers_of(polygons, "middles", file);
  for (std::size_t k = 0; k + 2 < middles.size(); k += 3) {
    const auto vertex = [&](std::size_t c) { return static_cast<std::uint32_t>(middles[k + c]); };
    to.middles.push_back({vertex(0), {vertex(1), vertex(2)}});
  }
}

}  // namespace

StoredSolution read_vtk(const std::filesystem::path& file) {
  if (!std::ifstream(file)) throw InputError(file.string(), "cannot be opened; is there such a file?");
  const vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
  // What is wrong is told by what is missing, and not by VTK.
  const vtkNew<vtkCallbackCommand> silence;
  silence->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
  reader->AddObserver(vtkCommand::ErrorEvent, silence);
  if (reader->CanReadFile(file.c_str()) == 0) refuse_file(file, "this is no VTK file of polygons");
  reader->Update();
  vtkPolyData& polygons = *reader->GetOutput();
  if (polygons.GetNumberOfCells() == 0) refuse_file(file, "there are no patches in it, or it is damaged");
  StoredSolution stored;
  add_run(stored, polygons, file);
  add_patches(stored, polygons, file);
  stored.radiosity = field_of(cell_array(polygons, "radiosity", file));
  stored.exitance = field_of(cell_array(polygons, "exitance", file));
  stored.reflectance = field_of(cell_array(polygons, "reflectance", file));
  return stored;
}

}  // namespace patchlight
