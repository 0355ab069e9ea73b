#include "archive/sampling_error_json.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace patchlight {
namespace {

nlohmann::ordered_json json_of(const SamplingError::Unanimous& unanimous) {
  return {{"sampled_again", unanimous.pairs},
          {"missed", unanimous.missed},
          {"bound", bound_on_miss(unanimous)},
          {"by_share", unanimous.by_share},
          {"squares", unanimous.squares}};
}

SamplingError::Unanimous unanimous_of(const nlohmann::json& json) {
  SamplingError::Unanimous unanimous;
  json.at("sampled_again").get_to(unanimous.pairs);
  json.at("missed").get_to(unanimous.missed);
  json.at("by_share").get_to(unanimous.by_share);
  // Folders of earlier versions have none.
  if (json.contains("squares")) json.at("squares").get_to(unanimous.squares);
  return unanimous;
}

}  // namespace

nlohmann::ordered_json json_of(const SamplingError& error) {
  if (!was_audited(error)) return nullptr;
  return {{"sampled_again", error.partial_pairs},
          {"squares", error.squares},
          {"probes_all_free", json_of(error.visible)},
          {"probes_all_blocked", json_of(error.occluded)}};
}

SamplingError sampling_error_of(const nlohmann::json& json) {
  SamplingError error;
  if (json.is_null()) return error;
  json.at("sampled_again").get_to(error.partial_pairs);
  json.at("squares").get_to(error.squares);
  error.visible = unanimous_of(json.at("probes_all_free"));
  error.occluded = unanimous_of(json.at("probes_all_blocked"));
  for (const double square : error.squares) {
    if (!(square >= 0 && std::isfinite(square))) throw std::out_of_range("a squared error is not a number above 0");
  }
  return error;
}

}  // namespace patchlight
