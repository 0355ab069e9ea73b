#include "output/vtk/read_vtk.h"

#include "patchlight/base/error.h"

#include "files/isolated.h"
#include "files/message.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vtkCellArray.h>
#include <vtkCellData.h>
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

// Numbers in files are doubles here. Those that are no index become the largest one, which names nothing.
std::uint32_t index_of(double number) {
  const std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  return number >= 0 && number < none ? static_cast<std::uint32_t>(number) : none;
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
  if (texts.empty()) refuse_file(file, std::string("the fact '") + name + "' is empty");
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

double number_of(vtkPolyData& polygons, const char* name, const std::filesystem::path& file) {
  const std::vector<double> numbers = numbers_of(polygons, name, file);
  if (numbers.empty()) refuse_file(file, std::string("the fact '") + name + "' is empty");
  return numbers.front();
}

std::uint64_t seed_of(vtkPolyData& polygons, const std::filesystem::path& file) {
  const std::string text = texts_of(polygons, "seed", file).front();
  const char* const end = text.data() + text.size();
  std::uint64_t seed = 0;
  const auto [past, error] = std::from_chars(text.data(), end, seed);
  if (error != std::errc() || past != end) refuse_file(file, "the fact 'seed' is no whole number");
  return seed;
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
    to.polygon.push_back(index_of(polygon.GetComponent(k, 0)));
    to.side.push_back(side.GetComponent(k, 0) == 0 ? Side::front : Side::back);
  }
}

void add_run(StoredSolution& to, vtkPolyData& polygons, const std::filesystem::path& file) {
  to.scene_hash = texts_of(polygons, "scene_hash", file).front();
  to.follows_reflections = number_of(polygons, "follows_reflections", file) != 0;
  to.converged = number_of(polygons, "converged", file) != 0;
  to.seed = seed_of(polygons, file);
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
    const auto vertex = [&](std::size_t c) { return index_of(middles[k + c]); };
    to.middles.push_back({vertex(0), {vertex(1), vertex(2)}});
  }
}

StoredSolution read_here(const std::filesystem::path& file) {
  const vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
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

}  // namespace

// The members that are sent between processes.
auto members_of(Is<Middle> auto& middle) { return std::tie(middle.vertex, middle.ends); }
auto members_of(Is<Decision> auto& decision) { return std::tie(decision.effect, decision.simulate, decision.forced); }
auto members_of(Is<StoredSolution> auto& stored) {
  return std::tie(stored.scene_hash, stored.vertices, stored.corners, stored.polygon, stored.side, stored.middles,
                  stored.radiosity, stored.exitance, stored.reflectance, stored.decisions, stored.follows_reflections,
                  stored.converged, stored.seed);
}

StoredSolution read_vtk(const std::filesystem::path& file) {
  if (!std::ifstream(file)) throw InputError(file.string(), "cannot be opened; is there such a file?");
  const std::string bytes = bytes_isolated(file.string(), [&] { return message_of(read_here(file)); });
  try {
    StoredSolution stored = value_in<StoredSolution>(bytes);
    const std::size_t patches = stored.corners.size();
    const auto is_side = [](Side side) { return side == Side::front || side == Side::back; };
    if (stored.polygon.size() != patches || stored.side.size() != patches || !std::ranges::all_of(stored.side, is_side))
      throw std::runtime_error("sizes disagree");
    return stored;
  } catch (const std::exception&) {
    refuse_file(file, "it cannot be read");
  }
}

}  // namespace patchlight
