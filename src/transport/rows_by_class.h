#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include "transport/ray_rows.h"

#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

namespace patchlight {

/// A specular material on a way, and whether light was mirrored there or went through.
struct SpecularMeeting {
  MaterialIndex material = 0;
  bool is_mirrored = false;

  bool operator<(const SpecularMeeting& other) const {
    return std::tie(material, is_mirrored) < std::tie(other.material, other.is_mirrored);
  }
};

/// Ways over the same specular materials, each as often, in any order; the meetings are sorted.
using WayClass = std::vector<SpecularMeeting>;

/// The name of a class: "glass + mirror mirrored"; "straight" without any.
std::string name_of(const WayClass& way_class, const Scene& scene);

/// A part of F_ij, by ways of one class.
struct ClassEntry {
  PatchIndex from = 0;
  PatchIndex to = 0;
  std::uint32_t way_class = 0;
  float form_factor = 0;
};

/// The form factors by specular ways, class by class, in one colour: F = F_0 + sum_c F_c, where F_0 is what rows have
/// of plain rays. Each is known from both halves of the rays, row by row, and not scaled to any sum. Ways that are
/// straight are those to and from clear patches and mirrors.
struct RowsByClass {
  std::vector<WayClass> classes;
  std::array<std::vector<ClassEntry>, 2> halves;
};

/// Of rows with stops, in the colour of `faces`. No ray is traced.
RowsByClass rows_by_class(const TracedRows& rows, const Scene& scene, const SpecularFaces& faces);

}  // namespace patchlight
