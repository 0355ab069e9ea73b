#include "output/vtk/write_series.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "output/file/write_bytes.h"
#include "output/vtk/vtk_polygons.h"
#include "render/tone_map.h"

#include <algorithm>
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

namespace patchlight {
namespace {

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

// What was made for a new series of which the .pvd does not speak yet: removed, last first, when the scope is left.
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
  const Pointer<vtkDoubleArray> up = numbers<vtkDoubleArray>("up", scene.up);
  up->SetNumberOfComponents(3);
  facts.AddArray(up);
  facts.AddArray(strings("unit_radiance", {"W/(m^2 sr)"}));
  facts.AddArray(strings("unit_irradiance", {"W/m^2"}));
  facts.AddArray(strings("unit_rgb", {"sRGB, 8 bits, at the recorded exposure"}));
}

// `colours_of` maps a radiance to colours.
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

// XML's five entities.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '&')
      result += "&amp;";
    else if (letter == '<')
      result += "&lt;";
    else if (letter == '>')
      result += "&gt;";
    else if (letter == '"')
      result += "&quot;";
    else if (letter == '\'')
      result += "&apos;";
    else
      result += letter;
  }
  return result;
}

std::string collection(const std::string& folder, const std::vector<std::string>& names,
                       const std::vector<Iteration>& history) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n"
      "  <Collection>\n";
  for (std::size_t k = 0; k < names.size(); ++k) {
    text += "    <DataSet timestep=\"" + std::to_string(history[k].number) + "\" part=\"0\" file=\"" +
            escaped(folder + "/" + names[k]) + "\"/>\n";
  }
  return text + "  </Collection>\n</VTKFile>\n";
}

// Files of an older series that the .pvd no longer names.
void remove_older(const fs::path& pvd, const std::vector<std::string>& names) {
  const std::set<std::string> kept(names.begin(), names.end());
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(series_folder(pvd), ignored)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file(ignored) && is_of_series(pvd, name) && !kept.contains(name)) {
      fs::remove(entry.path(), ignored);
    }
  }
}

// The folder of a series, which is one run's as long as this lives: what two runs wrote at a time, the first would
// lose.
class LockedFolder {
 public:
  LockedFolder(const fs::path& folder, const Observer& observer) {
    constexpr auto wait = std::chrono::milliseconds(20);
    while (!is_locked(folder)) {
      if (observer && !observer({.stage = Stage::write})) throw Cancelled();
      std::this_thread::sleep_for(wait);
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
    if (observer && !observer({.stage = Stage::write, .fraction = fraction})) throw Cancelled();
    const Pointer<vtkPolyData> polygons = polygons_of(simulation.mesh);
    add_values(*polygons->GetCellData(), simulation.problem, iterates[k].cast<double>(), exposed);
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
