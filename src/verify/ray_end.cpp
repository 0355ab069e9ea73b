#include "verify/ray_end.h"

#include <utility>

namespace patchlight {
namespace {

// A ray between mirrors that absorb nothing may go on for ever: what is left of it then counts as held by the last.
constexpr std::uint64_t most_meetings = 64;

}  // namespace

RayEnd end_of(const Met& met_by, std::optional<Hit> hit, std::uint32_t seed) {
  const auto& [occluder, surfaces, specular] = met_by;
  RayEnd end{std::move(hit), Spectrum::Ones(surfaces.sides[0].reflectance.size()), {}, {}};
  for (std::uint64_t meeting = 0; end.hit && specular[end.hit->polygon] != 0 && meeting < most_meetings; ++meeting) {
    const Hit met = *end.hit;
    const Surface& surface = surfaces.at(met.polygon, met.side);
    const double cosine = surface.normal.dot(met.direction);
    const double passing = occluder.transmittance(met.polygon, met.direction);
    const double reflected = occluder.specular_reflectance(met.polygon, met.direction);
    const double drawn = uniform({seed, meeting, 6});
    if (drawn >= passing + reflected) {
      end.factor *= relative_held(surface, cosine) / (1 - passing - reflected);
      break;
    }
    Ray onward{met.point, met.direction, met.polygon};
    if (drawn < passing) {
      end.factor *= transmittance(surface, cosine) / passing;
    } else {
      end.factor *= specular_reflectance(surface, cosine) / reflected;
      onward.direction = occluder.mirrored(met.polygon, met.direction);
      end.mirrored.push_back(onward);
      end.of_mirrored.push_back(end.factor);
    }
    end.hit = occluder.first_hits({&onward, 1}).front();
    if (!end.hit) break;
    end.hit->distance += met.distance;
    end.hit->reflections = met.reflections + (drawn < passing ? 0 : 1);
  }
  return end;
}

}  // namespace patchlight
