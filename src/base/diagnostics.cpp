#include "patchlight/base/diagnostics.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <sstream>

namespace patchlight {
namespace {

// In the order of the codes.
constexpr std::string_view code_names =
    "no_lamp covered_lamp missing_material_file unknown_material self_intersecting left_out implausible_size "
    "guessed_up full_reflectance moved_material_file no_material turned_faces non_planar duplicate_faces "
    "overlapping_faces misplaced_luminaire doubtful_sensor little_left_out two_sided_faces non_manifold_edges "
    "zero_area repeated_corners "
    "welded_vertices reduced_model maintenance_factor assumed_material simplified_part cut_out_material "
    "unreadable_picture simplified_picture read_as_pane read_as_mirror lowered_reflectance simplified_light "
    "renamed_material north_of_file missing_sensors unlit_sides sealed_solid outward_normals both_sides "
    "sun_below_horizon idle_option translucent_sheet contact_lines shadow_edges fine_outline "
    "more_patches rows_of_rays second_mesh unfollowed_reflection close_lamp lost_light checkpoint";

const std::vector<std::string>& names_of_codes() {
  static const std::vector<std::string> names = [] {
    std::istringstream words{std::string(code_names)};
    return std::vector<std::string>(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }();
  return names;
}

}  // namespace

const std::string& name_of(DiagnosticCode code) { return names_of_codes().at(static_cast<std::size_t>(code)); }

std::optional<DiagnosticCode> diagnostic_code(std::string_view name) {
  const auto found = std::find(names_of_codes().begin(), names_of_codes().end(), name);
  if (found == names_of_codes().end()) return std::nullopt;
  return static_cast<DiagnosticCode>(found - names_of_codes().begin());
}

bool makes_results_wrong(DiagnosticCode code) {
  return code == DiagnosticCode::left_out || code == DiagnosticCode::implausible_size ||
         code == DiagnosticCode::guessed_up || code == DiagnosticCode::misplaced_luminaire;
}

bool is_note(DiagnosticCode code) { return severity_of(code) == Severity::note; }

Severity severity_of(DiagnosticCode code) {
  // A model without a lamp is complete: a sky or a luminaire can light it.
  if (code == DiagnosticCode::no_lamp) return Severity::warning;
  if (code <= DiagnosticCode::self_intersecting) return Severity::error;
  if (code <= DiagnosticCode::doubtful_sensor) return Severity::warning;
  return code <= DiagnosticCode::welded_vertices ? Severity::remark : Severity::note;
}

const char* name_of(Severity severity) {
  constexpr std::array names = {"error", "warning", "remark", "note"};
  return names.at(static_cast<std::size_t>(severity));
}

Diagnostics worst_first(Diagnostics diagnostics) {
  std::stable_sort(diagnostics.begin(), diagnostics.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.code < b.code; });
  return diagnostics;
}

Diagnostics chosen(Diagnostics all, bool (*is_chosen)(DiagnosticCode)) {
  std::erase_if(all, [is_chosen](const Diagnostic& found) { return !is_chosen(found.code); });
  return all;
}

Diagnostics merged(std::vector<Diagnostics> lists) {
  Diagnostics all;
  for (Diagnostics& list : lists) std::move(list.begin(), list.end(), std::back_inserter(all));
  return all;
}

std::vector<std::string> texts_of(const Diagnostics& diagnostics) {
  std::vector<std::string> texts;
  for (const Diagnostic& diagnostic : diagnostics) texts.push_back(diagnostic.text);
  return texts;
}

}  // namespace patchlight
