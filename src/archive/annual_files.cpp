#include "archive/annual_files.h"

#include "archive/json_values.h"
#include "archive/npy.h"
#include "output/file/whole_file.h"

#include <array>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <string_view>

namespace patchlight {
namespace {

const FolderResult annual_folder{
    "annual.json",
    "annual",
    {"annual.json", "illuminance.npy", "sunlight.npy", "illuminance.ill", "sensors.csv", "rooms.csv", "hours.csv"}};

bool may_be_replaced(const std::filesystem::path& folder) { return holds_result(folder, annual_folder); }

void write_rows(const std::filesystem::path& file, const HourlyValues& values) {
  write_npy(file, static_cast<std::size_t>(values.rows()), static_cast<std::size_t>(values.cols()),
            [&](std::size_t row, std::span<float> to) {
              for (std::size_t k = 0; k < to.size(); ++k)
                to[k] = values(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k));
            });
}

// Month, day and middle of the hour, then all sensors; 0 inside walls, as the format has no other word for it.
void write_ill(const std::filesystem::path& file, const AnnualOutput& output) {
  write_stream(file, [&](std::ostream& stream) {
    stream << std::setprecision(5);
    for (std::size_t row = 0; row < output.hours.size(); ++row) {
      const HourRow& hour = output.hours[row];
      stream << hour.month << ' ' << hour.day << ' ' << hour.hour << ".5";
      for (const float value : output.light.illuminance.row(static_cast<Eigen::Index>(row)))
        stream << ' ' << (std::isnan(value) ? 0.0 : static_cast<double>(value));
      stream << '\n';
    }
  });
}

template <std::size_t count>
std::string cells(const std::array<Measure, count>& measures) {
  std::string text;
  for (const auto& [value, error] : measures) text += ',' + csv_cell(value) + ',' + csv_cell(error);
  return text + '\n';
}

template <class Name, std::size_t count>
std::string columns() {
  std::string text;
  for (std::size_t m = 0; m < count; ++m) {
    const std::string name = name_of(static_cast<Name>(m));
    text += ',' + name + ",SE_" + name;
  }
  return text + '\n';
}

std::string sensor_table(const AnnualOutput& output) {
  std::string text = "group,x,y,z,nx,ny,nz" + columns<SensorMeasure, sensor_measures>();
  std::size_t number = 0;
  for (const SensorGroup& group : output.groups) {
    for (const auto& [point, normal] : group.sensors) {
      text += csv_cell(group.name);
      for (const Vector& part : {Vector(point), normal})
        for (const double x : part) text += ',' + csv_cell(x);
      text += cells(output.metrics.sensors[number++]);
    }
  }
  return text;
}

std::string room_line(const RoomYear& room) {
  return csv_cell(room.name) + ',' + std::to_string(room.sensors) + ',' + std::to_string(room.inside_walls) +
         cells(room.measures);
}

std::string room_table(const AnnualOutput& output) {
  std::string text = "room,sensors,inside_walls" + columns<RoomMeasure, room_measures>();
  for (const RoomYear& room : output.metrics.rooms) text += room_line(room);
  return text + room_line(output.metrics.building);
}

std::string hour_table(const AnnualOutput& output) {
  std::string text =
      "month,day,hour,sun_altitude_deg,sun_azimuth_deg,direct_normal_W_m2,diffuse_horizontal_W_m2,direct_normal_lx,"
      "diffuse_horizontal_lx,occupied\n";
  for (const HourRow& row : output.hours) {
    text += std::to_string(row.month) + ',' + std::to_string(row.day) + ',' + std::to_string(row.hour);
    for (const double value : {row.sun_altitude, row.sun_azimuth, row.direct_normal, row.diffuse_horizontal,
                               row.direct_normal_lux, row.diffuse_horizontal_lux})
      text += ',' + csv_cell(value);
    text += row.is_occupied ? ",1\n" : ",0\n";
  }
  return text;
}

// A number, or null where it is none.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json room_part(const RoomYear& room) {
  Json part;
  part["name"] = json_of(room.name);
  part["sensors"] = room.sensors;
  part["inside_walls"] = room.inside_walls;
  for (std::size_t m = 0; m < room_measures; ++m) {
    const auto& [value, error] = room.measures[m];
    part[name_of(static_cast<RoomMeasure>(m))] = {{"value", number(value)}, {"standard_error", number(error)}};
  }
  return part;
}

Json facts(const AnnualOutput& output) {
  const AnnualLight& light = output.light;
  Json json;
  json["kind"] = annual_folder.kind;
  json["command_line"] = json_of(output.command_line);
  json["weather"] = json_of(output.weather);
  json["hours"] = output.hours.size();
  json["occupied"] = {{"from", output.first_hour}, {"to", output.last_hour}, {"hours", output.metrics.occupied_hours}};
  json["sky_division"] = output.sky_division;
  json["patches"] = light.patches;
  json["hours_with_sun"] = light.sun_hours;
  json["hours_with_sky"] = light.sky_hours;
  json["building"] = room_part(output.metrics.building);
  json["rooms"] = Json::array();
  for (const RoomYear& room : output.metrics.rooms) json["rooms"].push_back(room_part(room));
  json["daylight_factor_percent"] = Json::array();
  json["solved_daylight_factor_percent"] = Json::array();
  for (Eigen::Index i = 0; i < light.daylight_factor.size(); ++i) {
    json["daylight_factor_percent"].push_back(number(light.daylight_factor[i]));
    json["solved_daylight_factor_percent"].push_back(number(light.solved_daylight_factor[i]));
  }
  json["costs"] = Json::array();
  for (const PhaseCost& cost : light.costs)
    json["costs"].push_back({{"phase", cost.phase}, {"seconds", cost.seconds}, {"cpu_seconds", cost.cpu_seconds}});
  return json;
}

}  // namespace

void write_annual(const std::filesystem::path& folder, const AnnualOutput& output) {
  write_whole_folder(folder, may_be_replaced, [&](const std::filesystem::path& to) {
    write_rows(to / "illuminance.npy", output.light.illuminance);
    write_rows(to / "sunlight.npy", output.light.sunlight);
    write_ill(to / "illuminance.ill", output);
    write_bytes(to / "sensors.csv", sensor_table(output));
    write_bytes(to / "rooms.csv", room_table(output));
    write_bytes(to / "hours.csv", hour_table(output));
    write_bytes(to / "annual.json", facts(output).dump(1) + '\n');
  });
}

void check_annual_writable(const std::filesystem::path& folder) { check_folder_writable(folder, may_be_replaced); }

}  // namespace patchlight
