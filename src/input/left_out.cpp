#include "input/left_out.h"

#include "base/words.h"
#include "input/text.h"
#include "scene/model_face.h"

#include <algorithm>
#include <set>

namespace patchlight {
namespace {

// A diagnostic on all parts of one kind that were left out for one reason.
struct Remark {
  DiagnosticCode code = DiagnosticCode::left_out;
  std::string sentence;
  std::vector<std::string> names = {};  // the first ones
  bool has_more_names = false;
  std::size_t count = 0;
  std::vector<ModelFace> faces = {};
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
  std::vector<ModelFace>& faces = entries_[found->second].faces;
  faces.insert(faces.end(), entry.faces.begin(), entry.faces.end());
}

void LeftOut::add(const std::string& sentence, const std::string& name, DiagnosticCode code) {
  count({code, sentence, name, 1, {}});
}

void LeftOut::lose(const std::string& sentence, const std::string& name) {
  count({DiagnosticCode::left_out, sentence, name, 1, {}});
}

void LeftOut::lose_face(const std::string& sentence, const std::string& object, ModelFace face) {
  count({{}, sentence, object, 1, {std::move(face)}});
}

void LeftOut::lose_without_area(const std::string& sentence, const std::string& name, std::size_t number) {
  if (number > 0) count({DiagnosticCode::little_left_out, sentence, name, number, {}});
}

Scene LeftOut::on(Scene scene) const {
  const std::set<std::string> objects = objects_with_faces(scene);
  const auto code_of = [&](const Entry& entry) {
    const bool has_more = entry.name.empty() || objects.count(entry.name) > 0;
    return entry.code.value_or(has_more ? DiagnosticCode::little_left_out : DiagnosticCode::left_out);
  };
  std::vector<Remark> remarks;
  for (const Entry& entry : entries_) {
    const DiagnosticCode code = code_of(entry);
    auto found = std::find_if(remarks.begin(), remarks.end(), [&](const Remark& remark) {
      return remark.code == code && remark.sentence == entry.sentence;
    });
    if (found == remarks.end()) found = remarks.insert(found, {.code = code, .sentence = entry.sentence});
    found->count += entry.count;
    found->faces.insert(found->faces.end(), entry.faces.begin(), entry.faces.end());
    if (entry.name.empty()) continue;
    found->has_more_names = found->names.size() == 5;
    if (!found->has_more_names) found->names.push_back(entry.name);
  }
  for (const Remark& remark : remarks)
    scene.diagnostics.push_back(
        {remark.code, text_of(remark, scene.file), remark.count, remark.faces, area_of(remark.faces)});
  return scene;
}

}  // namespace patchlight
