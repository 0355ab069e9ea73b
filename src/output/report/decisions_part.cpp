#include "output/report/decisions_part.h"

namespace patchlight {

nlohmann::ordered_json decisions_part(const std::vector<Decision>& decisions) {
  nlohmann::ordered_json part = nlohmann::ordered_json::array();
  for (const Decision& decision : decisions) {
    part.push_back({{"effect", name_of(decision.effect)},
                    {"simulate", decision.simulate},
                    {"reason", decision.reason},
                    {"saving", decision.saving},
                    {"forced", decision.forced}});
  }
  return part;
}

}  // namespace patchlight
