#include "input/left_out.h"

#include "input/at_line.h"
#include "input/text.h"
#include "scene/problem_face.h"

#include <algorithm>
#include <optional>
#include <set>

namespace patchlight {
namespace {

constexpr std::size_t most_names = 5;

// A note or problem on all things of one kind that were left out for one reason.
struct Remark {
  std::optional<ProblemKind> kind;  // nothing for a note
  std::string sentence;
  std::vector<std::string> names = {};  // the first ones
  bool has_more_names = false;
  std::size_t count = 0;
  std::vector<ProblemFace> faces = {};
};

// "sentence: 7 (a, b, c, ...; first at room.obj:12)".
std::string text_of(const Remark& remark, const std::string& file) {
  std::string where = listed(remark.names) + (remark.has_more_names ? ", ..." : "");
  if (!remark.faces.empty() && remark.faces[0].line > 0)
    where += (where.empty() ? "first at " : "; first at ") + at_line(file, remark.faces[0].line);
  return remark.sentence + ": " + std::to_string(remark.count) + (where.empty() ? "" : " (" + where + ")");
}

}  // namespace

void LeftOut::count(Entry entry) {
  const auto [found, is_new] = index_.emplace(std::pair(entry.sentence, entry.name), entries_.size());
  if (is_new) return entries_.push_back(std::move(entry));
  entries_[found->second].count += entry.count;
  std::vector<ProblemFace>& faces = entries_[found->second].faces;
  faces.insert(faces.end(), entry.faces.begin(), entry.faces.end());
}

void LeftOut::add(const std::string& sentence, const std::string& name) {
  count({Part::remark, sentence, name, 1, {}});
}

void LeftOut::lose(const std::string& sentence, const std::string& name) {
  count({Part::object, sentence, name, 1, {}});
}

void LeftOut::lose_face(const std::string& sentence, const std::string& object, ProblemFace face) {
  count({Part::face, sentence, object, 1, {std::move(face)}});
}

void LeftOut::lose_without_area(const std::string& sentence, const std::string& name, std::size_t number) {
  if (number > 0) count({Part::without_area, sentence, name, number, {}});
}

Scene LeftOut::on(Scene scene) const {
  const std::set<std::string> objects = objects_with_faces(scene);
  const auto kind_of = [&](const Entry& entry) -> std::optional<ProblemKind> {
    if (entry.part == Part::remark) return std::nullopt;
    if (entry.part == Part::object) return ProblemKind::left_out;
    if (entry.part == Part::without_area || entry.name.empty()) return ProblemKind::little_left_out;
    return objects.count(entry.name) > 0 ? ProblemKind::little_left_out : ProblemKind::left_out;
  };
  std::vector<Remark> remarks;
  for (const Entry& entry : entries_) {
    const auto kind = kind_of(entry);
    auto found = std::find_if(remarks.begin(), remarks.end(), [&](const Remark& remark) {
      return remark.kind == kind && remark.sentence == entry.sentence;
    });
    if (found == remarks.end()) found = remarks.insert(found, {.kind = kind, .sentence = entry.sentence});
    found->count += entry.count;
    found->faces.insert(found->faces.end(), entry.faces.begin(), entry.faces.end());
    if (entry.name.empty()) continue;
    found->has_more_names = found->names.size() == most_names;
    if (!found->has_more_names) found->names.push_back(entry.name);
  }
  for (const Remark& remark : remarks) {
    const std::string text = text_of(remark, scene.file);
    if (remark.kind)
      scene.problems.push_back({*remark.kind, remark.count, text, remark.faces, area_of(remark.faces)});
    else
      scene.notes.push_back(text);
  }
  return scene;
}

}  // namespace patchlight
