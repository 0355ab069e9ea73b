#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace patchlight {
namespace {

// A face opposite at this share of a patch's edge takes `allowed` of its hemisphere.
constexpr double near = 0.6;
constexpr double allowed = 0.35;

// What has gone wrong in the gaps of ten rooms, as a share of the irradiance that could have.
constexpr double gap_scale = 0.5;

// Normals of faces that look back at each other have a product below this one.
constexpr double opposed = -0.5;

// How far patch i is in front of patch j when this is near and looks back; nothing when not.
std::optional<double> gap_to(const PatchMesh& mesh, PatchIndex i, PatchIndex j) {
  if (mesh.normal[i].dot(mesh.normal[j]) > opposed) return {};
  const double distance = (mesh.centroid[i] - mesh.centroid[j]).dot(mesh.normal[j]);
  const bool is_near = distance >= 0 && distance < near * std::sqrt(mesh.area[i]);
  return is_near ? std::optional(distance) : std::nullopt;
}

// What the near faces of a patch send it, added up one by one.
struct NearFaces {
  double share = 0;    // of the patch's hemisphere that they take
  double light = 0;    // sum of F_ij B_j, W/m^2
  double lossy = 0;    // the same of what is lost on its way along the patch
  double squares = 0;  // sum of F_ij B_j^2

  // Part of the light that may be uneven over the patch. What is lost is, and what its sources differ.
  double uneven() const {
    if (!(light > 0)) return 0;
    const double variance = share * squares / (light * light) - 1;
    return std::min(1.0, lossy / light + std::sqrt(std::max(0.0, variance)));
  }
};

// Gaps between patches, in the light of a solution.
class Gaps {
 public:
  Gaps(const PatchMesh& mesh, const SolvedProblem& solved)
      : mesh_(mesh),
        radiosity_(solved.solution.radiosity.rowwise().sum()),
        reflectance_(solved.problem.scattering.reflectance.rowwise().minCoeff()) {}

  // In a gap of width g light is reflected (w / g)^2 times before it has got along a patch of width w, as steps at
  // random add up; two of them lose 1 - rho_i rho_j. Between faces that reflect everything light is as even as its
  // sources are, however large the patches.
  void add(NearFaces& sum, PatchIndex i, PatchIndex j, double form_factor) const {
    const std::optional<double> gap = gap_to(mesh_, i, j);
    if (!gap) return;
    const double lost = (1 - reflectance_[i] * reflectance_[j]) * mesh_.area[i];
    const double light = form_factor * radiosity_[j];
    sum.share += form_factor;
    sum.light += light;
    sum.lossy += lost < *gap * *gap ? light * lost / (*gap * *gap) : light;
    sum.squares += light * radiosity_[j];
  }

 private:
  const PatchMesh& mesh_;
  Eigen::ArrayXd radiosity_;    // of all bands, W/m^2
  Eigen::ArrayXd reflectance_;  // the lowest of all bands
};

void add_row(NearFaces& sum, const Gaps& gaps, const RayRows& rows, PatchIndex i) {
  constexpr double half = 0.5;
  for (std::uint64_t k = rows.first_hit[i]; k < rows.first_hit[i + 1]; ++k)
    gaps.add(sum, i, rows.hits[k], half * rows.hit_weight[i]);
  for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k)
    gaps.add(sum, i, rows.entries[k].patch, half * static_cast<double>(rows.entries[k].form_factor));
}

// H_i / 2 times what near faces take of the hemisphere beyond what one does, and what of their light may be uneven.
template <typename NearFacesOf>
Field errors_by_share(const Field& irradiance, const NearFacesOf& near_faces_of) {
  Eigen::ArrayXd share(irradiance.rows());
  parallel_for(static_cast<std::size_t>(share.size()), [&](std::size_t row) {
    const NearFaces faces = near_faces_of(static_cast<PatchIndex>(row));
    const double beyond_one = std::clamp((faces.share - allowed) / (1 - allowed), 0.0, 1.0);
    share[static_cast<Eigen::Index>(row)] = beyond_one * faces.uneven();
  });
  return irradiance.colwise() * (gap_scale * share);
}

}  // namespace

Field gap_errors(const PatchMesh& mesh, const ExchangeAreas& S, const SolvedProblem& solved) {
  const Gaps gaps(mesh, solved);
  return errors_by_share(solved.solution.irradiance, [&](PatchIndex i) {
    NearFaces faces;
    for (PatchIndex j = 0; j < mesh.size(); ++j)
      gaps.add(faces, i, j, static_cast<double>(S.at(std::min(i, j), std::max(i, j))) / solved.problem.area[i]);
    return faces;
  });
}

Field gap_errors(const PatchMesh& mesh, const RayTransport& transport, const SolvedProblem& solved) {
  const Gaps gaps(mesh, solved);
  return errors_by_share(solved.solution.irradiance, [&](PatchIndex i) {
    NearFaces faces;
    for (const std::size_t half : {0, 1}) add_row(faces, gaps, transport.rows(half), i);
    return faces;
  });
}

}  // namespace patchlight
