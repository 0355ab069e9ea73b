#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/transport/transport_operator.h"

#include "transport/lamp_factors.h"
#include "transport/ray_rows.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

namespace patchlight {

/// The exchange between the patches of a mesh, by rows of rays. Geometry alone decides the form factors. The light at
/// the time of tracing decides which lamps are found apart from the rows and toward which bright patches rays are sent:
/// other light scatters more.
struct RayExchange {
  TracedRows rows;
  std::vector<PatchRange> lamps;  ///< found apart: the patches of a side each, which emit alike
  LampFactors lamp_factors;       ///< per patch and lamp
  std::vector<std::array<double, 2>> specular_kinds = {};  ///< SpecularFaces::kinds() of the polygons by which rows
                                                           ///< were traced; empty where none is specular
};

/// Transport by sparse rows of rays, Storage::rays: H = F B, where F is the mean of two halves. Its rows sum up to what
/// patches see, but A_i F_ij and A_j F_ji differ by the errors of both. One application reads every entry once.
class RayTransport : public TransportOperator {
 public:
  explicit RayTransport(std::array<RayRows, 2> halves) : halves_(std::move(halves)) {}

  PatchIndex size() const override { return static_cast<PatchIndex>(halves_[0].hit_weight.size()); }
  Field apply(const FieldView& radiosity) const override;
  bool is_reciprocal() const override { return false; }

  /// The same by one half of the rays alone, 0 or 1.
  Field apply_half(std::size_t half, const FieldView& radiosity) const;

  /// F 1, the same bits as apply() has, without looking at what is met.
  Eigen::VectorXd row_sums() const;

  const RayRows& rows(std::size_t half) const { return halves_[half]; }

 private:
  std::array<RayRows, 2> halves_;
};

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
