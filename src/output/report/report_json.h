#pragma once

#include "patchlight/output/write_result.h"
#include "patchlight/plan/effects.h"
#include "patchlight/report/report.h"
#include "patchlight/simulate.h"

#include <nlohmann/json.hpp>
#include <vector>

namespace patchlight {

/// Diagnostics as objects with their code, severity and text.
inline nlohmann::ordered_json json_of(const Diagnostics& diagnostics) {
  auto array = nlohmann::ordered_json::array();
  for (const Diagnostic& found : diagnostics)
    array.push_back(
        {{"code", name_of(found.code)}, {"severity", name_of(severity_of(found.code))}, {"text", found.text}});
  return array;
}

/// The text of a JSON file. Names from a model may hold bytes that are not UTF-8: they are replaced.
std::string json_text(const nlohmann::ordered_json& json);

/// The values in their order. Numbers that are not finite are written as null.
template <class Values>
nlohmann::ordered_json json_array(const Values& values) {
  auto array = nlohmann::ordered_json::array();
  for (const auto& value : values) array.push_back(value);
  return array;
}

/// An array of objects with name, kind, file, place, position_m and aim.
nlohmann::ordered_json luminaires_part(const std::vector<Luminaire>& luminaires);

/// The relative errors that the last of the steps has reached; null without any. docs/reference/outputs/report-json.md
/// lists the keys.
nlohmann::ordered_json relative_errors(const std::vector<AccuracyStep>& steps);

/// Those of the patches inside and outside closed shells with openings, where these divide them; else null.
nlohmann::ordered_json relative_errors_by_space(const std::vector<SpaceErrors>& spaces);

/// An array of objects with effect, simulate, reason, saving and forced.
nlohmann::ordered_json decisions_part(const std::vector<Decision>& decisions);

/// The report as write_report() writes it.
nlohmann::ordered_json report_json(const Report& report, const Provenance& provenance);

}  // namespace patchlight
