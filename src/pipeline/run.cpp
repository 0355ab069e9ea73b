#include "pipeline/run.h"

namespace patchlight {

Given given_by(const Steps& with) {
  return {.form_factors = static_cast<bool>(with.exchange),
          .ray_rows = static_cast<bool>(with.ray_exchange),
          .mesh = static_cast<bool>(with.mesh),
          .solver = static_cast<bool>(with.solve)};
}

}  // namespace patchlight
