#include "patchlight/base/error.h"
#include "patchlight/scene/scene.h"

#include "base/words.h"
#include "files/isolated.h"
#include "files/reason.h"
#include "files/sha256.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/read_model.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

// The files of the program and of the shared library with this code, e.g. the Python module.
std::vector<fs::path> own_files() {
  std::error_code error;
  std::vector<fs::path> files = {fs::read_symlink("/proc/self/exe", error)};
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&own_files), &info) != 0 && info.dli_fname != nullptr) {
    files.push_back(fs::canonical(info.dli_fname, error));
  }
  return files;
}

// $XDG_DATA_DIRS (XDG Base Directory Specification)
std::vector<fs::path> data_folders() {
  const char* const stated = std::getenv("XDG_DATA_DIRS");
  std::istringstream list(stated != nullptr && *stated != '\0' ? stated : "/usr/local/share:/usr/share");
  std::vector<fs::path> folders;
  for (std::string folder; std::getline(list, folder, ':');)
    if (fs::path(folder).is_absolute()) folders.emplace_back(folder);
  return folders;
}

// Finds `name` ("ifc/read_ifc.mjs") among the files that patchlight installs into share/patchlight. Searches the
// folders above the program or library, including the build tree, then XDG_DATA_DIRS. Empty if not found.
fs::path shared_file(const fs::path& name) {
  std::vector<fs::path> folders;
  for (const fs::path& file : own_files()) {
    for (fs::path above = file.parent_path(); above.has_relative_path(); above = above.parent_path())
      folders.push_back(above / "share");
  }
  for (const fs::path& folder : data_folders()) folders.push_back(folder);
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::path found = fs::canonical(folder / "patchlight" / name, error);
    if (!error && fs::is_regular_file(found, error)) return found;
  }
  return {};
}

using IfcJson = nlohmann::json;

struct IfcTriangles {
  std::vector<Point> points;  // meters
  std::vector<std::array<std::uint32_t, 3>> corners;
};

IfcTriangles ifc_triangles(const IfcJson& line, double scale) {
  const auto coordinates = line.at("points").get<std::vector<double>>();
  const auto numbers = line.at("triangles").get<std::vector<std::uint32_t>>();
  if (coordinates.size() % 3 != 0 || numbers.size() % 3 != 0) throw std::out_of_range("a triangle is not complete");
  IfcTriangles read;
  for (std::size_t k = 0; k < coordinates.size(); k += 3)
    read.points.push_back(scale * Point(coordinates[k], coordinates[k + 1], coordinates[k + 2]));
  for (const std::uint32_t number : numbers)
    if (number >= read.points.size()) throw std::out_of_range("a triangle names a point that is not there");
  for (std::size_t k = 0; k < numbers.size(); k += 3)
    read.corners.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
  return read;
}

Material ifc_material(const IfcJson& line) {
  const IfcJson& color = line.at("color");
  if (color.is_null()) return default_material();
  const auto parts = color.get<std::array<double, 3>>();
  Material material{line.at("material").get<std::string>(), rgb(parts[0], parts[1], parts[2]), rgb(0, 0, 0)};
  const double transparency = line.at("transparency").get<double>();
  if (!(transparency > 0)) return material;
  return as_pane(std::move(material), Spectrum::Constant(3, transparency), usual_index,
                 "opacity " + rounded(1 - transparency));
}

// "A102 Living room": numbers alone are unclear, and names repeat.
std::string room_name(const std::string& name, const std::string& long_name) {
  if (name.empty() || long_name.empty() || name == long_name) return name.empty() ? long_name : name;
  return name + " " + long_name;
}

// Collects the scene from the lines.
class IfcScene {
 public:
  IfcScene(const std::string& file, std::optional<double> metres_per_unit) : metres_per_unit_(metres_per_unit) {
    scene_.file = file;
  }

  void add(const IfcJson& line) {
    if (line.contains("refusal")) throw InputError(scene_.file, line.at("refusal").get<std::string>());
    if (line.contains("material")) {
      if (line.contains("element")) {
        add_element(line);
      } else {
        scene_.materials.push_back(ifc_material(line));
      }
    }
    // Points come in meters, converted by the unit of the file.
    if (line.contains("unit") && metres_per_unit_) scale_ = *metres_per_unit_ / line.at("unit").get<double>();
    if (line.contains("north") && !line.at("north").is_null()) set_north(line.at("north").get<std::array<double, 2>>());
    if (line.contains("space")) add_space(line);
    if (line.contains("without_faces"))
      left_out_.lose("elements whose shapes give no faces are left out", line.at("without_faces").get<std::string>());
    if (line.contains("end")) is_complete_ = true;
  }

  Scene scene() && {
    if (!is_complete_) throw std::runtime_error("its end is missing");
    scene_ = left_out_.on(std::move(scene_));
    return with_used_materials(std::move(scene_));
  }

 private:
  void set_north(const std::array<double, 2>& direction) {
    const Vector north(direction[0], direction[1], 0);
    if (!(north.norm() > 0)) return;
    scene_.north = north.normalized();
    scene_.north_stated = true;
    if (scene_.north.y() < 1)
      scene_.diagnostics.push_back(
          {DiagnosticCode::north_of_file, "true north of the file: [" + rounded(scene_.north.x()) + ", " +
                                              rounded(scene_.north.y()) +
                                              ", 0]; the key north of a scene file overrules it"});
  }

  void add_element(const IfcJson& line) {
    Polygon polygon;
    polygon.group = groups_.index_of(line.at("element").get<std::string>(), scene_.groups);
    polygon.material = line.at("material").get<MaterialIndex>();
    if (polygon.material >= scene_.materials.size()) throw std::out_of_range("a material is not there");
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    const IfcTriangles triangles = ifc_triangles(line, scale_);
    scene_.vertices.insert(scene_.vertices.end(), triangles.points.begin(), triangles.points.end());
    for (const auto& [a, b, c] : triangles.corners) {
      polygon.corners = {first + a, first + b, first + c};
      scene_.polygons.push_back(polygon);
    }
  }

  // A space has no faces: its body gives the extent of a room. A space may have several lines.
  void add_space(const IfcJson& line) {
    const auto [room, is_new] = rooms_.emplace(line.at("id").get<std::uint64_t>(), scene_.rooms.size());
    if (is_new) {
      scene_.rooms.push_back({room_name(line.at("space").get<std::string>(), line.at("long_name").get<std::string>()),
                              line.at("storey").get<std::string>(),
                              {}});
    }
    const IfcTriangles triangles = ifc_triangles(line, scale_);
    for (const auto& [a, b, c] : triangles.corners)
      scene_.rooms[room->second].faces.push_back({triangles.points[a], triangles.points[b], triangles.points[c]});
  }

  Scene scene_;
  std::optional<double> metres_per_unit_;
  double scale_ = 1;
  LeftOut left_out_;
  GroupIndex groups_;
  std::map<std::uint64_t, std::size_t> rooms_;
  bool is_complete_ = false;
};

// Builds the scene from the lines that ifc/read_ifc.mjs writes; the script documents them. Groups are elements, named
// by class, name and identifier. A transparency makes a pane. Spaces become rooms. True north comes from the file.
// `metres_per_unit` replaces the unit of the file. Throws InputError naming `file` when the script refuses it, or lines
// are damaged.
Scene scene_of_ifc_stream(std::string_view lines, const std::string& file, std::optional<double> metres_per_unit) {
  IfcScene read(file, metres_per_unit);
  try {
    while (!lines.empty()) {
      const std::size_t end = std::min(lines.find('\n'), lines.size());
      read.add(IfcJson::parse(lines.substr(0, end)));
      lines.remove_prefix(std::min(end + 1, lines.size()));
    }
    return std::move(read).scene();
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(file,
                     "the output of the IFC reader is damaged: " + reason_of(error) + "\nhint: export the file again");
  }
}

// The file of a program in PATH; empty if not found.
fs::path program_file(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::error_code error;
    fs::path file = fs::canonical(fs::path(folder) / name, error);
    if (!error && fs::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

// Node.js with the script that reads IFC with web-ifc, a package beside the script.
Program ifc_reader(const std::string& file) {
  const fs::path node = program_file("node");
  if (node.empty()) {
    throw InputError(file,
                     "IFC files need Node.js, which is not installed; run scripts/install_packages.sh of patchlight "
                     "or install the package nodejs");
  }
  const fs::path script = shared_file("ifc/read_ifc.mjs");
  if (script.empty() || !fs::exists(script.parent_path() / "node_modules/web-ifc/web-ifc-node.wasm")) {
    throw InputError(file,
                     "IFC files need the package web-ifc, which is not installed; run "
                     "scripts/install_packages.sh of patchlight");
  }
  return {{node, script}, {node.parent_path().parent_path(), script.parent_path()}};
}

}  // namespace

Scene read_ifc(const fs::path& file, std::optional<double> metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  const std::string lines = output_isolated(file.string(), ifc_reader(file.string()), bytes);
  Scene scene = scene_of_ifc_stream(lines, file.string(), metres_per_unit);
  scene.metres_per_unit = metres_per_unit.value_or(1);
  scene.unit_stated = !metres_per_unit;
  scene.up = Vector::UnitZ();
  scene.up_stated = true;
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

}  // namespace patchlight
