#include "archive/json_values.h"

#include <array>
#include <stdexcept>

namespace patchlight {
namespace {

bool is_utf8(const std::string& text) {
  try {
    return !Json(text).dump().empty();
  } catch (const Json::type_error&) {
    return false;
  }
}

}  // namespace

Json json_of(const std::string& text) {
  if (is_utf8(text)) return text;
  Json bytes = Json::array();
  for (const char letter : text) bytes.push_back(static_cast<unsigned char>(letter));
  return bytes;
}

Json json_of(const std::vector<std::string>& texts) {
  Json list = Json::array();
  for (const std::string& text : texts) list.push_back(json_of(text));
  return list;
}

Json json_of(const Spectrum& spectrum) { return std::vector<double>(spectrum.begin(), spectrum.end()); }

Json json_of(const Vector& vector) { return {vector.x(), vector.y(), vector.z()}; }

std::string text_of(const Json& json) {
  if (json.is_string()) return json.get<std::string>();
  std::string text;
  for (const Json& byte : json) text += static_cast<char>(byte.get<unsigned char>());
  return text;
}

std::vector<std::string> texts_of(const Json& json) {
  std::vector<std::string> texts;
  for (const Json& text : json) texts.push_back(text_of(text));
  return texts;
}

void require(bool condition, const std::string& otherwise) {
  if (!condition) throw std::out_of_range(otherwise);
}

Vector vector_of(const Json& json) {
  const auto coordinates = json.get<std::array<double, 3>>();
  return {coordinates[0], coordinates[1], coordinates[2]};
}

Spectrum spectrum_of(const Json& json) {
  const auto values = json.get<std::vector<double>>();
  return Eigen::Map<const Spectrum>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace patchlight
