#include "output/report/write_validation.h"

#include "patchlight/output/provenance.h"

#include "output/file/write_bytes.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace patchlight {
namespace {

// Keeps the keys in the order in which they are set.
using Json = nlohmann::ordered_json;

Json case_part(const ValidationResult& result) {
  Json part;
  part["case"] = result.name;
  part["exact"] = result.exact;
  part["exact_from"] = result.source;
  part["computed"] = result.measured.value;
  part["error_bar"] = result.measured.error_bar;
  part["error_bar_from"] = result.measured.bar_from;
  part["within_bar"] = within_bar(result);
  return part;
}

}  // namespace

std::string validation_json(std::span<const ValidationResult> results) {
  Json json;
  json["version"] = version();
  json["sound"] = std::all_of(results.begin(), results.end(), within_bar);
  json["cases"] = Json::array();
  for (const ValidationResult& result : results) json["cases"].push_back(case_part(result));
  return json.dump(2) + "\n";
}

void write_validation(const std::filesystem::path& file, std::span<const ValidationResult> results) {
  write_bytes(file, validation_json(results));
}

}  // namespace patchlight
