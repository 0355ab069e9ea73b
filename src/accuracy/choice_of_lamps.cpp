#include "accuracy/choice_of_lamps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace patchlight {

ChoiceOfLamps::Chosen ChoiceOfLamps::at(double u) const {
  const double place = u * before.back();
  const auto next = std::upper_bound(before.begin(), before.end() - 1, place);
  const auto k = static_cast<std::size_t>(next - before.begin()) - 1;
  const double of_lamp = before[k + 1] - before[k];
  return {lamps[k], of_lamp / before.back(), std::clamp((place - before[k]) / of_lamp, 0.0, 1.0)};
}

double ChoiceOfLamps::probability_of(PatchIndex patch) const {
  const auto place = std::lower_bound(lamps.begin(), lamps.end(), patch);
  if (place == lamps.end() || *place != patch) return 0;
  const auto k = static_cast<std::size_t>(place - lamps.begin());
  return (before[k + 1] - before[k]) / before.back();
}

ChoiceOfLamps choice_of_lamps(const PatchMesh& mesh, PatchIndex patch, const std::vector<PatchIndex>& lamps,
                              const Field& exitance) {
  constexpr double least_cosine = 0.05;  // of a lamp whose centroid is below the horizon some may be above it
  ChoiceOfLamps choice{lamps, {0}};
  for (const PatchIndex lamp : lamps) {
    const Vector toward = mesh.centroid[lamp] - mesh.centroid[patch];
    const double squared = toward.squaredNorm() + mesh.area[lamp];
    const double distance = std::sqrt(squared);
    const double cosines = std::max(least_cosine, mesh.normal[patch].dot(toward) / distance) *
                           std::max(least_cosine, -mesh.normal[lamp].dot(toward) / distance);
    choice.before.push_back(choice.before.back() + exitance.row(lamp).mean() * mesh.area[lamp] * cosines / squared);
  }
  return choice;
}

ChoiceOfLamps choice_by_flux(const PatchMesh& mesh, const std::vector<PatchIndex>& lamps, const Field& exitance) {
  ChoiceOfLamps choice{lamps, {0}};
  for (const PatchIndex lamp : lamps)
    choice.before.push_back(choice.before.back() + exitance.row(lamp).mean() * mesh.area[lamp]);
  return choice;
}

}  // namespace patchlight
