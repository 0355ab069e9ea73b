#include "output/image/write_observers.h"

#include "output/file/write_bytes.h"
#include "output/report/csv_cell.h"

#include <cmath>
#include <string>

namespace patchlight {

void write_observers(const std::filesystem::path& file, std::span<const ObserverReading> observers) {
  std::string text = "observer,E_vertical_lx,E_cylindrical_lx,L_background_cd_m2,glare_sr,UGR\n";
  for (const ObserverReading& one : observers) {
    text += csv_cell(one.name) + ',' + csv_cell(one.vertical_illuminance) + ',' +
            csv_cell(one.cylindrical_illuminance) + ',' + csv_cell(one.background_luminance) + ',' +
            csv_cell(one.glare_solid_angle) + ',' + csv_cell(one.unified_glare_rating.value_or(std::nan(""))) + '\n';
  }
  write_bytes(file, text);
}

}  // namespace patchlight
