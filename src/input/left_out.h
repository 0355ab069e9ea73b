#pragma once

#include "patchlight/scene/scene.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {

/// The reason for which readers leave out a face.
inline constexpr const char* too_few_corners = "faces with fewer than three corners, left out";

/// Parts of a file that a reader leaves out or simplifies: sentences with the names of the objects concerned.
class LeftOut {
 public:
  /// A note: the file intends it, or the result hardly changes.
  void add(const std::string& sentence, const std::string& name, DiagnosticCode code = DiagnosticCode::simplified_part);

  /// A loss: the scene lacks a whole object or light source of the file.
  void lose(const std::string& sentence, const std::string& name);

  /// A loss: the scene lacks a face of the object. The known corners give the area.
  void lose_face(const std::string& sentence, const std::string& object, ModelFace face = {});

  /// A loss that takes no area from the scene, e.g. lines and points.
  void lose_without_area(const std::string& sentence, const std::string& name, std::size_t count = 1);

  /// The scene with diagnostics "sentence: 7 (a, b, c, ...)", with the first five names, in the order of the first
  /// calls. A face whose object has no polygon in the scene counts as a whole object.
  Scene on(Scene scene) const;

 private:
  struct Entry {
    std::optional<DiagnosticCode> code;  // nothing for a face: it depends on the other faces of its object
    std::string sentence;
    std::string name;
    std::size_t count = 0;
    std::vector<ModelFace> faces;
  };

  void count(Entry entry);

  std::vector<Entry> entries_;
  std::map<std::pair<std::string, std::string>, std::size_t> index_;  // of entries, by sentence and name
};

}  // namespace patchlight
