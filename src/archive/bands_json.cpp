#include "archive/bands_json.h"

namespace patchlight {

nlohmann::ordered_json json_of(const Bands& bands) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Band& band : bands)
    list.push_back({{"name", band.name},
                    {"luminous_weight", band.luminous_weight},
                    {"rgb", band.rgb},
                    {"edges_nm", band.edges_nm}});
  return list;
}

Bands bands_from(const nlohmann::ordered_json& json) {
  Bands bands;
  for (const auto& entry : json) {
    bands.push_back({entry.at("name").get<std::string>(), entry.at("luminous_weight").get<double>(),
                     entry.at("rgb").get<std::array<double, 3>>(), entry.value("edges_nm", std::array<double, 2>{})});
  }
  return bands;
}

}  // namespace patchlight
