#include "scene/projection.h"

#include <cmath>

namespace patchlight {

const char* name_of(Projection projection) {
  switch (projection) {
    case Projection::orthographic:
      return "orthographic";
    case Projection::angular:
      return "angular";
    case Projection::hemispherical:
      return "hemispherical";
    case Projection::panorama:
      return "panorama";
    case Projection::perspective:
      break;
  }
  return "perspective";
}

std::optional<Projection> projection_named(const std::string& name) {
  using enum Projection;
  for (const Projection one : {perspective, orthographic, angular, hemispherical, panorama}) {
    if (name == name_of(one)) return one;
  }
  return std::nullopt;
}

double usual_field_of_view(Projection projection) { return projection == Projection::perspective ? 50 : 180; }

double largest_field_of_view(Projection projection) { return projection == Projection::angular ? 360 : 180; }

bool has_extent(const Camera& camera) {
  if (camera.projection == Projection::orthographic) return camera.height > 0 && std::isfinite(camera.height);
  const double angle = camera.vertical_field_of_view;
  const double largest = largest_field_of_view(camera.projection);
  return angle > 0 && (camera.projection == Projection::perspective ? angle < largest : angle <= largest);
}

}  // namespace patchlight
