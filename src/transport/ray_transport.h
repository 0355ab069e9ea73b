#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/transport/transport_operator.h"

#include "transport/emitter_factors.h"
#include "transport/ray_rows.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

namespace patchlight {

/// The exchange between the patches of a mesh, by rows of rays. Geometry alone decides the form factors. The light at
/// the time of tracing decides which emitters are separate and which bright patches rays sample directly. Other light
/// has more noise.
struct RayExchange {
  TracedRows rows;
  std::vector<PatchRange> emitters;  ///< separate emitters: the patches of one side each, with equal emission
  EmitterFactors emitter_factors;    ///< per patch and lamp
  /// SurfaceOptics::kinds() of the polygons at the time of tracing; empty if none is specular.
  std::vector<std::array<double, 2>> specular_kinds = {};
};

/// Transport by sparse rows of rays, Storage::rays: H = F B, where F is the mean of two halves. Rows sum to the visible
/// share of patches, but A_i F_ij and A_j F_ji differ by their sampling errors. One application reads every entry once.
class RayTransport : public TransportOperator {
 public:
  explicit RayTransport(std::array<RayRows, 2> halves) : halves_(std::move(halves)) {}

  PatchIndex size() const override { return static_cast<PatchIndex>(halves_[0].hit_weight.size()); }
  Field apply(const FieldView& radiosity) const override;
  bool is_reciprocal() const override { return false; }

  /// The same by one half of the rays only, 0 or 1.
  Field apply_half(std::size_t half, const FieldView& radiosity) const;

  /// F 1 with the same bits as apply(), but without reading which patches are hit.
  Eigen::VectorXd row_sums() const;

  const RayRows& rows(std::size_t half) const { return halves_[half]; }

 private:
  std::array<RayRows, 2> halves_;
};

/// The adjoint F* of F in the inner product sum_i A_i x_i y_i: F*_ji = A_i F_ij / A_j. As F is reciprocal but for its
/// sampling errors, so is F*; sum_i A_i x_i (F y)_i = sum_j A_j (F* x)_j y_j holds up to the rounding of entries to
/// floats. `area` in m^2; patches of area 0 have no row. O(rays) time and memory.
RayTransport adjoint_of(const RayTransport& rays, const Eigen::VectorXd& area);

/// A specular material on a path, and whether light was mirrored or transmitted there.
struct SpecularMeeting {
  MaterialIndex material = 0;
  bool is_mirrored = false;

  bool operator<(const SpecularMeeting& other) const {
    return std::tie(material, is_mirrored) < std::tie(other.material, other.is_mirrored);
  }
};

/// A class of paths with the same specular materials, each the same number of times, in any order; sorted.
using WayClass = std::vector<SpecularMeeting>;

/// The name of a class: "glass + mirror mirrored"; "straight" for a class without materials.
std::string name_of(const WayClass& way_class, const Scene& scene);

/// The part of F_ij by paths of one class.
struct ClassEntry {
  PatchIndex from = 0;
  PatchIndex to = 0;
  std::uint32_t way_class = 0;
  float form_factor = 0;
};

/// The form factors by specular paths, class by class, in one color: F = F_0 + sum_c F_c, where F_0 is the part of
/// plain rays. Each is computed from both halves of the rays, row by row, and not scaled. Straight paths are those to
/// and from clear patches and mirrors.
struct RowsByClass {
  std::vector<WayClass> classes;
  std::array<std::vector<ClassEntry>, 2> halves;
};

/// Splits rows with stops into classes, in the color of `faces`. No ray is traced.
RowsByClass rows_by_class(const TracedRows& rows, const Scene& scene, const SurfaceOptics& faces);

}  // namespace patchlight
