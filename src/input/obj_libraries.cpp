#include "input/obj_libraries.h"

#include "base/lower_case.h"
#include "input/at_line.h"
#include "input/text.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace patchlight {
namespace {

// A file that an mtllib statement names, and where it is; an empty place when it is nowhere.
struct LibraryFile {
  std::string name;
  std::filesystem::path place;
  bool moved = false;  // it is beside the model instead of where the statement says
};

bool is_file(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::is_regular_file(file, error);
}

// The files of a folder by their names in lower case, of several names that differ in capitals alone the first. Listed
// when it is asked for, once.
class Folder {
 public:
  explicit Folder(std::filesystem::path place) : place_(std::move(place)) {}

  const std::filesystem::path& place() const { return place_; }
  std::optional<std::filesystem::path> similar(const std::filesystem::path& name) {
    if (!listed_) list();
    const auto found = names_.find(in_lower_case(name.string()));
    return found == names_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  void list() {
    listed_ = true;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(place_.empty() ? "." : place_, error)) {
      const std::filesystem::path name = entry.path().filename();
      const auto [found, is_new] = names_.emplace(in_lower_case(name.string()), name);
      if (!is_new && name < found->second) found->second = name;
    }
  }

  std::filesystem::path place_;
  std::map<std::string, std::filesystem::path> names_;
  bool listed_ = false;
};

// Where the name says; else beside the model, under the last part of the name, in capitals or not. A path may have been
// written under Windows. What lies outside of `confine` is refused before anybody looks whether it is there.
LibraryFile find_library(Folder& beside, const std::string& name, const std::string& where,
                         const std::filesystem::path& confine) {
  const std::filesystem::path& folder = beside.place();
  std::string slashes = name;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  for (const std::string& path : {name, slashes}) {
    require_within(confine, folder / path, where);
    if (is_file(folder / path)) return {name, folder / path};
  }
  const std::filesystem::path last = std::filesystem::path(slashes).filename();
  if (last.empty()) return {name, {}};
  if (is_file(folder / last)) return {name, folder / last, true};
  const std::optional<std::filesystem::path> similar = beside.similar(last);
  if (!similar || !is_file(folder / *similar)) return {name, {}};
  require_within(confine, folder / *similar, where);
  return {name, folder / *similar, true};
}

// The files an mtllib statement names. A name may hold spaces: when the whole statement is a file, it is the only one.
std::vector<LibraryFile> library_files(Folder& beside, const ObjName& statement, const std::string& where,
                                       const std::filesystem::path& confine) {
  const LibraryFile whole = find_library(beside, statement.name, where, confine);
  if (!whole.place.empty() && !whole.moved) return {whole};
  std::vector<LibraryFile> files;
  for (const std::string_view name : words(statement.name)) {
    files.push_back(find_library(beside, std::string(name), where, confine));
  }
  const bool all_there = std::all_of(files.begin(), files.end(), [](const auto& file) { return !file.place.empty(); });
  return all_there || whole.place.empty() ? files : std::vector{whole};
}

// A texture stands beside the material file; its path may have been written under Windows.
std::string place_of(std::string texture, const std::filesystem::path& library) {
  std::replace(texture.begin(), texture.end(), '\\', '/');
  return texture.empty() ? texture : (library.parent_path() / texture).string();
}

// The file and the textures that its materials name, which stand beside it.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& library,
                                            const std::vector<MtlMaterial>& materials) {
  std::vector<std::filesystem::path> files = {library};
  for (const MtlMaterial& material : materials) {
    for (const std::string& texture : material.textures) files.push_back(library.parent_path() / texture);
  }
  return files;
}

std::optional<Problem> problem_with(const LibraryFile& file, const std::string& where) {
  const std::string found = "mtllib (" + where + ") names '" + file.name + "', ";
  if (file.place.empty()) {
    return Problem{ProblemKind::missing_material_file,
                   1,
                   found +
                       "which is neither there nor beside the model; the materials that no other file defines "
                       "are grey, reflectance 0.5",
                   {}};
  }
  if (!file.moved) return std::nullopt;
  return Problem{ProblemKind::moved_material_file,
                 1,
                 found + "which is not there; " + file.place.string() + " is taken instead",
                 {}};
}

}  // namespace

Libraries read_libraries(const std::filesystem::path& obj, const std::vector<ObjName>& statements,
                         const std::filesystem::path& confine) {
  Libraries libraries;
  Folder beside(obj.parent_path());
  std::set<std::string> names;
  std::set<std::filesystem::path> places;
  for (const ObjName& statement : statements) {
    const std::string where = at_line(obj, statement.line);
    for (const LibraryFile& file : library_files(beside, statement, where, confine)) {
      if (!names.insert(file.name).second) continue;
      const std::optional<Problem> problem = problem_with(file, where);
      if (problem) libraries.problems.push_back(*problem);
      if (file.place.empty() || !places.insert(file.place).second) continue;
      libraries.texts.push_back(read_text(file.place, where, "the material file " + file.place.string()));
      std::vector<MtlMaterial> materials = read_mtl(libraries.texts.back(), file.place.string());
      const std::vector<std::filesystem::path> named = files_of(file.place, materials);
      libraries.files.insert(libraries.files.end(), named.begin(), named.end());
      for (MtlMaterial& material : materials) {
        material.diffuse_texture = place_of(material.diffuse_texture, file.place);
        material.mask_picture = place_of(material.mask_picture, file.place);
      }
      libraries.materials.insert(libraries.materials.end(), materials.begin(), materials.end());
    }
  }
  return libraries;
}

}  // namespace patchlight
