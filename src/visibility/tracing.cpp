#include "visibility/tracing.h"

#include "visibility/occluder.h"

#include <mutex>
#include <utility>

namespace patchlight {
namespace {

using Shared = std::shared_ptr<const Occluder>;

bool has_openings(const Scene& scene) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_opening(scene, p)) return true;
  }
  return false;
}

bool has_mirrors(const Scene& scene) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_mirror(scene, p, Side::front) || is_mirror(scene, p, Side::back)) return true;
  }
  return false;
}

}  // namespace

// What is made when it is first asked for.
struct Tracing::Later {
  std::once_flag all_once, opaque_once, clear_once;
  Shared all, opaque, clear;
};

Tracing::Tracing(const Scene& scene, Coverings coverings, Occluder::Blockers between_patches, Reflections reflections)
    : scene_(scene),
      coverings_(std::move(coverings)),
      kind_(between_patches),
      has_openings_(has_openings(scene)),
      has_specular_faces_(has_openings_ || has_mirrors(scene)),
      reflections_(reflections),
      between_patches_(std::make_shared<const Occluder>(scene, between_patches, coverings_, reflections)),
      later_(std::make_unique<Later>()) {}

Tracing::~Tracing() = default;

const Occluder& Tracing::all_faces() const {
  std::call_once(later_->all_once, [&] {
    const auto all = Occluder::Blockers::all;
    later_->all = kind_ == all ? between_patches_ : std::make_shared<const Occluder>(scene_, all, *between_patches_);
  });
  return *later_->all;
}

Shared Tracing::opaque_faces() const {
  std::call_once(later_->opaque_once, [&] {
    if (has_openings_) {
      later_->opaque = std::make_shared<const Occluder>(scene_, Occluder::Blockers::opaque, coverings_);
    } else {
      all_faces();
      later_->opaque = later_->all;
    }
  });
  return later_->opaque;
}

Shared Tracing::clear_faces() const {
  if (!has_openings_) return nullptr;
  std::call_once(later_->clear_once,
                 [&] { later_->clear = std::make_shared<const Occluder>(scene_, Occluder::Blockers::clear); });
  return later_->clear;
}

}  // namespace patchlight
