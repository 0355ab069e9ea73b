#include "base/part_of_stage.h"

namespace patchlight {

Observer part_of_stage(const Observer& observer, double from, double to) {
  if (!observer) return {};
  return [observer, from, to](const Progress& progress) {
    Progress all = progress;
    all.fraction = from + (to - from) * progress.fraction;
    return observer(all);
  };
}

}  // namespace patchlight
