#include "page/write_page.h"

#include "base/rounded.h"
#include "output/file/write_bytes.h"
#include "output/image/png_bytes.h"
#include "output/report/comparison_json.h"
#include "output/report/json_array.h"
#include "output/report/report_json.h"
#include "output/report/study_json.h"
#include "page/model_part.h"
#include "page/packed.h"
#include "page/page_parts.h"
#include "page/sensor_maps.h"

#include <algorithm>
#include <string_view>

namespace patchlight {
namespace {

using Json = nlohmann::ordered_json;

// So many faces of one code are shown.
constexpr std::size_t most_problem_faces = 200;

Json diagnostics_part(const Diagnostics& diagnostics) {
  Json parts = json_of(diagnostics);
  for (std::size_t n = 0; n < diagnostics.size(); ++n) {
    const std::vector<ModelFace>& faces = diagnostics[n].faces;
    parts[n]["outlines"] = Json::array();
    for (std::size_t k = 0; k < std::min(faces.size(), most_problem_faces); ++k) {
      Json outline = Json::array();
      for (const Point& corner : faces[k].corners) outline.push_back(json_array(corner));
      parts[n]["outlines"].push_back(std::move(outline));
    }
  }
  return parts;
}

std::string caption_of(const Picture& picture) {
  std::string text = picture.camera.name.empty() ? "" : picture.camera.name + ": ";
  text += picture.brightest ? "luminance in false colors, 0 to " + rounded(*picture.brightest) + " cd/m\u00b2"
                            : "natural colors";
  return picture.unfinished ? text + ", preliminary: the rendering was stopped early" : text;
}

Json picture_part(const Picture& picture) {
  const DisplayImage image =
      picture.brightest ? with_legend(picture.image, 0, *picture.brightest, "luminance, cd/m^2") : picture.image;
  Json part;
  part["caption"] = caption_of(picture);
  part["png"] = base64(png_bytes(image));
  part["width"] = image.width;
  part["height"] = image.height;
  const Camera& camera = picture.camera;
  part["camera"] = {{"eye", json_array(camera.eye)},
                    {"target", json_array(camera.target)},
                    {"vertical_field_of_view", camera.vertical_field_of_view},
                    {"projection", name_of(camera.projection)}};
  return part;
}

// That of the first picture as it looks: the model is then as bright as the picture is.
double exposure_of(const Page& page) {
  const auto looks = [](const Picture* picture) { return !picture->brightest; };
  const auto first = std::find_if(page.pictures.begin(), page.pictures.end(), looks);
  return first == page.pictures.end() ? page.provenance.exposure : (*first)->exposure;
}

Json data_of(const Page& page) {
  Json data;
  data["version"] = version();
  data["command_line"] = page.provenance.command_line;
  data["changes"] = page.provenance.changes;
  data["scene_hash"] = page.provenance.scene_hash;
  data["file"] = page.scene.file;
  data["files"] = page.scene.files;
  data["sha256"] = page.scene.sha256;
  data["diagnostics"] = diagnostics_part(page.scene.diagnostics);
  if (page.report != nullptr) data["report"] = report_json(*page.report, page.provenance);
  if (page.readings != nullptr) data["sensors"] = sensor_maps(page.scene, *page.readings);
  data["pictures"] = Json::array();
  for (const Picture* picture : page.pictures) data["pictures"].push_back(picture_part(*picture));
  if (page.comparison != nullptr) data["comparison"] = comparison_json(page.scene, *page.comparison, page.provenance);
  if (page.study != nullptr) data["study"] = study_json(page.scene, *page.study, page.provenance);
  if (page.surface != nullptr) data["model"] = model_part(*page.surface, exposure_of(page));
  if (page.surface != nullptr) data["three"] = packed_text(page_scripts(), 1);
  return data;
}

// The text with other words in place of some letters.
std::string replaced(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> words) {
  std::string out;
  out.reserve(text.size());
  for (const char letter : text) {
    const auto* const found =
        std::find_if(words.begin(), words.end(), [letter](const auto& word) { return word.first == letter; });
    found == words.end() ? out.append(1, letter) : out.append(found->second);
  }
  return out;
}

// JSON in HTML: without "<" nothing in it can end the element that it stands in, or open another. Names from a model
// may hold bytes that are not UTF-8: they are replaced.
std::string json_in_html(const Json& json) {
  return replaced(json.dump(-1, ' ', false, Json::error_handler_t::replace), {{'<', "\\u003c"}});
}

std::string text_in_html(const std::string& text) {
  const std::string valid = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return replaced(Json::parse(valid).get<std::string>(),
                  {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}});
}

}  // namespace

std::string page_of(const Page& page) {
  const std::string title = std::filesystem::path(page.scene.file).filename().string() + " \u00b7 patchlight";
  const std::string_view whole = page_template();
  constexpr std::string_view title_mark = "@TITLE@", data_mark = "@DATA@";
  const std::size_t title_at = whole.find(title_mark), data_at = whole.find(data_mark);
  const std::size_t after_title = title_at + title_mark.size();
  std::string html(whole.substr(0, title_at));
  html += text_in_html(title);
  html += whole.substr(after_title, data_at - after_title);
  html += json_in_html(data_of(page));
  html += whole.substr(data_at + data_mark.size());
  return html;
}

void write_page(const std::filesystem::path& file, const Page& page) { write_bytes(file, page_of(page)); }

}  // namespace patchlight
