#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace patchlight {
namespace {

// A face opposite at this share of a patch's edge takes `allowed` of its hemisphere.
constexpr double near = 0.6;
constexpr double allowed = 0.35;

// The measured error in the gaps of ten rooms, relative to the irradiance at risk.
constexpr double gap_scale = 0.5;

// Normals of faces that look back at each other have a product below this one.
constexpr double opposed = -0.5;

// True when patch j is nearer to patch i than this share of its edge and looks back at it.
bool is_near(const PatchMesh& mesh, PatchIndex i, PatchIndex j, double within) {
  if (mesh.normal[i].dot(mesh.normal[j]) > opposed) return false;
  const double distance = (mesh.centroid[i] - mesh.centroid[j]).dot(mesh.normal[j]);
  return distance >= 0 && distance < within * std::sqrt(mesh.area[i]);
}

// The sources of a patch: the share of its hemisphere with near faces that look back, and the range of radiosities.
class SeenSources {
 public:
  SeenSources(const PatchMesh& mesh, const Field& radiosity, double within)
      : mesh_(mesh),
        radiosity_(radiosity),
        within_(within),
        least_(Spectrum::Constant(radiosity.cols(), std::numeric_limits<double>::infinity())),
        largest_(Spectrum::Zero(radiosity.cols())) {}

  void add(PatchIndex i, PatchIndex j, double form_factor) {
    if (!(form_factor > 0)) return;
    sum_ += form_factor;
    if (is_near(mesh_, i, j, within_)) near_ += form_factor;
    least_ = least_.min(radiosity_.row(j));
    largest_ = largest_.max(radiosity_.row(j));
  }
  // The rest of the hemisphere is dark.
  Spectrum range() const { return sum_ < complete ? largest_ : Spectrum(largest_ - least_); }
  double near_share() const { return near_; }

 private:
  // Row sums are 1 in closed rooms, except for single-precision rounding and leaks.
  static constexpr double complete = 1 - 1e-3;

  const PatchMesh& mesh_;
  const Field& radiosity_;
  double within_;
  double sum_ = 0, near_ = 0;
  Spectrum least_, largest_;
};

void add_row(SeenSources& seen, const RayRows& rows, PatchIndex i, double weight) {
  for (std::uint64_t k = rows.first_hit[i]; k < rows.first_hit[i + 1]; ++k)
    seen.add(i, rows.hits[k], weight * rows.hit_weight[i]);
  for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k)
    seen.add(i, rows.entries[k].patch, weight * static_cast<double>(rows.entries[k].form_factor));
}

// Half of the light that a patch in a gap would get wrong, times the share of near faces beyond that of one. Light from
// sources of one radiosity is right wherever it comes from, so no more is wrong than their range and the direct light.
template <typename AddSources>
Field errors_in_gaps(const PatchMesh& mesh, const SolvedProblem& solved, double within, const AddSources& add_sources) {
  const Field& H = solved.solution.irradiance;
  const Field& direct = solved.problem.direct_irradiance;
  Field errors(H.rows(), H.cols());
  parallel_for(mesh.size(), [&](std::size_t row) {
    const auto i = static_cast<PatchIndex>(row);
    SeenSources seen(mesh, solved.solution.radiosity, within);
    add_sources(seen, i);
    const double share = std::clamp((seen.near_share() - allowed) / (1 - allowed), 0.0, 1.0);
    Spectrum uneven = seen.range();
    if (direct.size() > 0) uneven += direct.row(i);
    errors.row(i) = gap_scale * share * uneven.min(H.row(i));
  });
  return errors;
}

}  // namespace

Field gap_errors(const PatchMesh& mesh, const ExchangeAreas& S, const SolvedProblem& solved) {
  return errors_in_gaps(mesh, solved, near, [&](SeenSources& seen, PatchIndex i) {
    for (PatchIndex j = 0; j < mesh.size(); ++j)
      seen.add(i, j, static_cast<double>(S.at(std::min(i, j), std::max(i, j))) / solved.problem.area[i]);
  });
}

Field gap_errors(const PatchMesh& mesh, const RayTransport& transport, const SolvedProblem& solved, int cuts) {
  return errors_in_gaps(mesh, solved, std::ldexp(near, -cuts), [&](SeenSources& seen, PatchIndex i) {
    for (const std::size_t half : {0U, 1U}) add_row(seen, transport.rows(half), i, 0.5);
  });
}

}  // namespace patchlight
