#include "input/read_model.h"

#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/scene/scene.h"

#include "base/near_match.h"
#include "input/building/read_gbxml.h"
#include "input/building/read_hbjson.h"
#include "input/collada/read_collada.h"
#include "input/gltf/read_gltf.h"
#include "input/ifc/read_ifc.h"
#include "input/mesh/read_off.h"
#include "input/mesh/read_ply.h"
#include "input/mesh/read_stl.h"
#include "input/mitsuba/read_mitsuba.h"
#include "input/obj/read_obj.h"
#include "input/radiance/read_radiance.h"
#include "input/stated_panes.h"
#include "input/text.h"
#include "input/xml_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace patchlight {
namespace {

// Reads an XML file by its first element: <scene> is a Mitsuba scene, <gbXML> a building. Throws InputError naming
// the file and the line.
Scene read_xml(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  const XmlFile xml = read_xml_file(file, file.string());
  const std::string root = xml.document.document_element().name();
  if (root == "scene") return read_mitsuba(file, metres_per_unit, confine);
  if (root == "gbXML") return read_gbxml(xml, metres_per_unit);
  throw InputError(file.string(), "the first element is <" + root +
                                      ">; expected <scene>, of a Mitsuba scene, or <gbXML>, of a building");
}

// ".obj, .ply, ..."
std::string allowed_extensions() {
  std::string list;
  for (const std::string& format : readable_formats()) list += (list.empty() ? "." : ", .") + format;
  return list;
}

Scene read_format(const std::filesystem::path& file, const std::string& format, double metres_per_unit,
                  const std::filesystem::path& confine) {
  if (format == "obj") return read_obj(file, metres_per_unit, confine);
  if (format == "ply") return read_ply(file, metres_per_unit);
  if (format == "stl") return read_stl(file, metres_per_unit);
  if (format == "off") return read_off(file, metres_per_unit);
  if (format == "dae") return read_collada(file, metres_per_unit, confine);
  if (format == "gltf" || format == "glb") return read_gltf(file, metres_per_unit, confine);
  if (format == "hbjson") return read_hbjson(file, metres_per_unit);
  if (format == "xml") return read_xml(file, metres_per_unit, confine);
  throw InputError(file.string(),
                   "the extension '." + format + "' is not known; expected one of " + allowed_extensions());
}

// With the given unit instead of that of the file, which states one unless it is XML of Mitsuba.
Scene read_in_unit(const std::filesystem::path& file, const std::string& format, std::optional<double> metres_per_unit,
                   const std::filesystem::path& confine) {
  if (format == "ifc") return read_ifc(file, metres_per_unit);
  constexpr std::array<const char*, 5> stating = {"dae", "gltf", "glb", "hbjson", "xml"};
  const bool states_unit = std::find(stating.begin(), stating.end(), format) != stating.end();
  if (!states_unit) return read_format(file, format, metres_per_unit.value_or(1), confine);
  Scene scene = read_format(file, format, 1, confine);
  // Mitsuba states neither its unit nor the upright axis, the others both.
  scene.unit_stated = scene.up_stated && !metres_per_unit;
  if (!metres_per_unit) return scene;
  double stated = scene.metres_per_unit;
  if (format == "dae") stated = collada_unit(read_text(file, file.string(), "the model file"));
  if (*metres_per_unit != stated) scene = read_format(file, format, *metres_per_unit / stated, confine);
  scene.metres_per_unit = *metres_per_unit;
  return scene;
}

// "; did you mean 'room.obj'?" when its folder has a file of such a name; nothing where it cannot be read.
std::string near_file(const std::filesystem::path& file) {
  constexpr std::size_t most = 10'000;
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end && names.size() < most;
       entry.increment(error)) {
    std::error_code unknown;
    if (!entry->is_directory(unknown)) names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  const std::string nearest = near_match(file.filename().string(), names);
  return nearest.empty() ? "" : "; did you mean '" + (file.parent_path() / nearest).string() + "'?";
}

}  // namespace

std::string format_of(const std::filesystem::path& file) {
  if (file == "-") return "obj";
  std::string text = file.extension().string();
  if (!text.empty()) text.erase(0, 1);
  text = in_lower_case(std::move(text));
  if (text == "mat") return "rad";
  return text == "gbxml" ? "xml" : text;
}

void require_file(const std::filesystem::path& file, const std::string& where, bool near_names) {
  if (file == "-") return;
  std::error_code error;
  const std::string name = where == file ? "" : file.string() + ": ";
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() != std::filesystem::file_type::not_found && error) {
    throw InputError(where, name + "the model file cannot be opened: " + error.message());
  }
  if (!std::filesystem::exists(status)) {
    const std::string hint = near_names ? near_file(file) : "";
    throw InputError(where, name + "the model file does not exist; check the name and the folder" + hint);
  }
  if (std::filesystem::is_directory(status)) {
    throw InputError(where, name + "this is a folder; expected a model file (" + allowed_extensions() + ")");
  }
}

FileModel read_model(const std::filesystem::path& file, const std::string& format,
                     std::optional<double> metres_per_unit, const std::filesystem::path& confine,
                     RadianceModifiers known) {
  require_within(confine, file, file.string());
  FileModel model;
  if (format == "rad") {
    RadianceModel read = read_radiance(file, metres_per_unit.value_or(1), confine, std::move(known));
    model = {std::move(read.scene), std::move(read.modifiers)};
  } else {
    model = {without_doubtful_panes(read_in_unit(file, format, metres_per_unit, confine)), std::move(known)};
  }
  if (file != "-") model.scene.inputs.push_back(file);
  return model;
}

}  // namespace patchlight
