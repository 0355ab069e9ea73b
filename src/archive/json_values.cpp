#include "archive/json_values.h"

#include <array>
#include <cmath>
#include <cstdint>
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

// One member of each.
template <std::size_t n, class Value>
Json members_of(const std::array<AuditedPairs, n>& kinds, Value AuditedPairs::*member) {
  Json values = Json::array();
  for (const AuditedPairs& audited : kinds) values.push_back(audited.*member);
  return values;
}

double sum_of_squares(const nlohmann::json& json) {
  const auto sum = json.get<double>();
  if (!(sum >= 0 && std::isfinite(sum))) throw std::out_of_range("a sum of squares is not a number above 0");
  return sum;
}

template <std::size_t n>
std::array<AuditedPairs, n> audited_of(const nlohmann::json& pairs, const nlohmann::json& squares,
                                       const nlohmann::json& weights) {
  std::array<AuditedPairs, n> kinds{};
  for (std::size_t k = 0; k < n; ++k)
    kinds[k] = {pairs.at(k).get<std::uint64_t>(), sum_of_squares(squares.at(k)), sum_of_squares(weights.at(k))};
  return kinds;
}

Json counts_of(const SamplingError::Unanimous& unanimous) {
  return {{"sampled_again", members_of(unanimous.audited, &AuditedPairs::pairs)},
          {"squares", members_of(unanimous.audited, &AuditedPairs::squares)},
          {"weights", members_of(unanimous.audited, &AuditedPairs::weight)},
          {"missed", unanimous.missed},
          {"bound", bound_on_miss(unanimous)},
          {"by_share", unanimous.by_share}};
}

SamplingError::Unanimous unanimous_of(const nlohmann::json& json) {
  SamplingError::Unanimous unanimous;
  unanimous.audited = audited_of<sampling_efforts>(json.at("sampled_again"), json.at("squares"), json.at("weights"));
  json.at("missed").get_to(unanimous.missed);
  json.at("by_share").get_to(unanimous.by_share);
  return unanimous;
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

nlohmann::ordered_json json_of(const SamplingError& error) {
  if (!was_audited(error)) return nullptr;
  Json pairs = Json::array();
  Json squares = Json::array();
  Json weights = Json::array();
  for (const auto& of_effort : error.partial) {
    pairs.push_back(members_of(of_effort, &AuditedPairs::pairs));
    squares.push_back(members_of(of_effort, &AuditedPairs::squares));
    weights.push_back(members_of(of_effort, &AuditedPairs::weight));
  }
  return {{"sampled_again", pairs},
          {"squares", squares},
          {"weights", weights},
          {"rays_all_free", counts_of(error.visible)},
          {"rays_all_blocked", counts_of(error.occluded)}};
}

SamplingError sampling_error_of(const nlohmann::json& json) {
  SamplingError error;
  // Folders of earlier versions lack this part.
  if (json.is_null() || !json.contains("weights")) return error;
  for (std::size_t effort = 0; effort < sampling_efforts; ++effort) {
    error.partial[effort] = audited_of<SamplingError::bins>(
        json.at("sampled_again").at(effort), json.at("squares").at(effort), json.at("weights").at(effort));
  }
  error.visible = unanimous_of(json.at("rays_all_free"));
  error.occluded = unanimous_of(json.at("rays_all_blocked"));
  return error;
}

}  // namespace patchlight
