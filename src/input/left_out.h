#pragma once

#include "patchlight/scene/scene.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {

/// Why readers leave out a face.
inline constexpr const char* too_few_corners = "faces with fewer than three corners, left out";

/// Things of a file that a reader leaves out or simplifies: sentences, each with the names of the objects concerned.
class LeftOut {
 public:
  /// A remark: the file means it so, or the result hardly changes.
  void add(const std::string& sentence, const std::string& name);

  /// A loss: the scene lacks a whole object or light source of the file.
  void lose(const std::string& sentence, const std::string& name);

  /// A loss: the scene lacks a face of the object. Its corners, as far as they are known, give the area.
  void lose_face(const std::string& sentence, const std::string& object, ProblemFace face = {});

  /// A loss that takes no area from the scene, e.g. lines and points.
  void lose_without_area(const std::string& sentence, const std::string& name, std::size_t count = 1);

  /// The scene with the remarks as notes and the losses as problems, "sentence: 7 (a, b, c, ...)", with the first five
  /// names. They stand in the order of the first calls. A face whose object has no polygon in the scene
  /// counts as a whole object.
  Scene on(Scene scene) const;

 private:
  enum class Part { remark, object, face, without_area };
  struct Entry {
    Part part = Part::remark;
    std::string sentence;
    std::string name;
    std::size_t count = 0;
    std::vector<ProblemFace> faces;
  };

  void count(Entry entry);

  std::vector<Entry> entries_;
  std::map<std::pair<std::string, std::string>, std::size_t> index_;  // of entries, by sentence and name
};

}  // namespace patchlight
