#include "transport/specular_stops.h"

#include <algorithm>

namespace patchlight {
namespace {

// With which probability a ray was mirrored; where no ray is now, nothing goes on whatever it was.
double mirrored_rays(const SpecularFaces& faces, const SpecularStop& stop) {
  const SpecularFace* const face = faces.at(stop.polygon);
  return face ? face->mirrored_rays(stop.side(), stop.cosine()) : 1;
}

// What is left of the light after a stop, over the probability that the ray went this way.
double onward_share(const SpecularShares& shares, const SpecularFaces& faces, const SpecularStop& stop) {
  if (stop.step() == RayStep::crossed) return shares.transmitted;
  if (stop.step() == RayStep::sent) return shares.relative_held;
  const bool is_mirrored = stop.step() == RayStep::mirrored;
  const double share = is_mirrored ? shares.mirrored : shares.transmitted;
  if (share == 0) return 0;
  const double p = mirrored_rays(faces, stop);
  return share / (is_mirrored ? p : 1 - p);
}

}  // namespace

void SpecularStop::set(RayStep step, Side on, double of_angle) {
  constexpr double most = 0x1p28 - 1;
  const double steps = std::clamp(of_angle * 0x1p28, 0.0, most);
  bits =
      static_cast<std::uint32_t>(step) | static_cast<std::uint32_t>(on) << 3U | static_cast<std::uint32_t>(steps) << 4U;
}

void tell_form_factors(std::span<const SpecularStop> stops, const SpecularFaces& faces,
                       const std::function<void(const SpecularStop& stop, double form_factor)>& tell) {
  double left = 1;
  for (const SpecularStop& stop : stops) {
    const auto counted = static_cast<double>(stop.form_factor);
    if (stop.step() == RayStep::ends) {
      tell(stop, left * counted);
      left = 1;
      continue;
    }
    const SpecularShares shares = faces.shares(stop.polygon, stop.side(), stop.cosine());
    const bool goes_on = stop.step() != RayStep::kept;
    tell(stop, left * shares.held * counted);
    left = goes_on ? left * onward_share(shares, faces, stop) : 1;
  }
}

}  // namespace patchlight
