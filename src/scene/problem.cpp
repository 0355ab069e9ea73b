#include "patchlight/scene/problem.h"

#include <algorithm>

namespace patchlight {

const char* name_of(ProblemKind kind) {
  switch (kind) {
    case ProblemKind::no_lamp:
      return "no_lamp";
    case ProblemKind::covered_lamp:
      return "covered_lamp";
    case ProblemKind::missing_material_file:
      return "missing_material_file";
    case ProblemKind::unknown_material:
      return "unknown_material";
    case ProblemKind::self_intersecting:
      return "self_intersecting";
    case ProblemKind::left_out:
      return "left_out";
    case ProblemKind::implausible_size:
      return "implausible_size";
    case ProblemKind::guessed_up:
      return "guessed_up";
    case ProblemKind::full_reflectance:
      return "full_reflectance";
    case ProblemKind::moved_material_file:
      return "moved_material_file";
    case ProblemKind::no_material:
      return "no_material";
    case ProblemKind::turned_faces:
      return "turned_faces";
    case ProblemKind::non_planar:
      return "non_planar";
    case ProblemKind::duplicate_faces:
      return "duplicate_faces";
    case ProblemKind::overlapping_faces:
      return "overlapping_faces";
    case ProblemKind::little_left_out:
      return "little_left_out";
    case ProblemKind::two_sided_faces:
      return "two_sided_faces";
    case ProblemKind::non_manifold_edges:
      return "non_manifold_edges";
    case ProblemKind::zero_area:
      return "zero_area";
    case ProblemKind::repeated_corners:
      return "repeated_corners";
    case ProblemKind::welded_vertices:
      return "welded_vertices";
  }
  return "";
}

std::optional<ProblemKind> problem_kind(std::string_view name) {
  for (auto k = static_cast<std::uint8_t>(ProblemKind::no_lamp);
       k <= static_cast<std::uint8_t>(ProblemKind::welded_vertices); ++k) {
    const auto kind = static_cast<ProblemKind>(k);
    if (name == name_of(kind)) return kind;
  }
  return std::nullopt;
}

bool makes_results_wrong(ProblemKind kind) { return kind == ProblemKind::left_out || kind == ProblemKind::guessed_up; }

Severity severity_of(ProblemKind kind) {
  // A model without a lamp is complete: a sky or a luminaire can light it.
  if (kind == ProblemKind::no_lamp) return Severity::warning;
  if (kind <= ProblemKind::self_intersecting) return Severity::error;
  return kind <= ProblemKind::overlapping_faces ? Severity::warning : Severity::remark;
}

const char* name_of(Severity severity) {
  switch (severity) {
    case Severity::error:
      return "error";
    case Severity::warning:
      return "warning";
    case Severity::remark:
      return "remark";
  }
  return "";
}

std::vector<Problem> worst_first(std::vector<Problem> problems) {
  std::stable_sort(problems.begin(), problems.end(),
                   [](const Problem& a, const Problem& b) { return a.kind < b.kind; });
  return problems;
}

}  // namespace patchlight
