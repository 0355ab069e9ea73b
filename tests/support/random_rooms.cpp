#include "support/random_rooms.h"

#include "base/sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace patchlight::test {
namespace {

using Faces = std::vector<RoomFace>;

constexpr double degree = std::numbers::pi / 180;

// Random numbers of one room; they depend on the order of the calls.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : seed_(seed) {}
  double unit() { return (hash({seed_, count_++}) + 0.5) * 0x1p-32; }
  bool chance(double probability) { return unit() < probability; }
  int whole(int low, int high) { return low + static_cast<int>(unit() * (high - low + 1)); }
  // Rounded to millimeters, or thousandths of another unit.
  double between(double low, double high) { return std::round(1000 * (low + unit() * (high - low))) / 1000; }
  // Log-uniform: equally likely from 20 to 100 and from 100 to 500.
  double log_between(double low, double high) {
    return std::round(1000 * std::exp(std::log(low) + unit() * std::log(high / low))) / 1000;
  }
  template <class T>
  T pick(const std::vector<T>& values) {
    return values[static_cast<std::size_t>(whole(0, static_cast<int>(values.size()) - 1))];
  }

 private:
  std::uint32_t seed_;
  std::uint64_t count_ = 0;
};

// A parallelogram whose front looks along u x v.
RoomFace make_face(const std::string& group, const std::string& material, const Point& corner, const Vector& u,
                   const Vector& v) {
  return {group, material, {corner, corner + u, corner + u + v, corner + v}};
}

enum class Facing { inward, outward };

// The faces of a box whose sides are named in `sides`, e.g. "+x-x+y-y+z" for one without a bottom.
Faces make_box(const std::string& group, const std::string& material, const Point& low, const Point& high,
               const std::string& sides = "+x-x+y-y+z-z", Facing facing = Facing::outward) {
  const Vector size = high - low;
  Faces faces;
  for (std::size_t k = 0; k + 1 < sides.size(); k += 2) {
    const int axis = sides[k + 1] - 'x';
    const bool is_high = sides[k] == '+';
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    const Vector u = size[next] * Vector::Unit(next), v = size[last] * Vector::Unit(last);
    const Point corner = is_high ? Point(low + size[axis] * Vector::Unit(axis)) : low;
    const bool along_axis = is_high == (facing == Facing::outward);
    faces.push_back(make_face(group, material, corner, along_axis ? u : v, along_axis ? v : u));
  }
  return faces;
}

Faces turn_about(Faces faces, const Point& centre, double degrees) {
  const Eigen::AngleAxisd rotation(degrees * degree, Vector::UnitZ());
  for (RoomFace& face : faces)
    for (Point& corner : face.corners) corner = centre + rotation * (corner - centre);
  return faces;
}

Box bounds_of(const Faces& faces) {
  Box box;
  for (const RoomFace& face : faces)
    for (const Point& corner : face.corners) box.extend(corner);
  return box;
}

// A room under construction, and the bodies in it that sensors keep away from.
struct Draft {
  RandomRoom room;
  Dice dice;
  std::vector<Box> bodies;

  void add(const Faces& faces) { room.faces.insert(room.faces.end(), faces.begin(), faces.end()); }
  void add_body(const Faces& faces) {
    add(faces);
    bodies.push_back(bounds_of(faces));
  }
  void add_material(const std::string& name, double reflectance, double exitance = 0) {
    room.materials.push_back({name, {reflectance, reflectance, reflectance}, exitance});
  }
};

// True if the point is at least this far from all bodies.
bool is_free(const Draft& draft, const Point& point, double distance) {
  return std::none_of(draft.bodies.begin(), draft.bodies.end(),
                      [&](const Box& body) { return body.exteriorDistance(point) < distance; });
}

// True if the faces keep 2 cm from all bodies.
bool fits(const Draft& draft, const Faces& faces) {
  const Box box = bounds_of(faces);
  return std::none_of(draft.bodies.begin(), draft.bodies.end(),
                      [&](const Box& body) { return body.exteriorDistance(box) < 0.02; });
}

// A point of a box that is this far from all bodies.
Point find_place(Draft& draft, const Point& low, const Point& high, double distance) {
  for (int k = 0; k < 1000; ++k) {
    Point point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = draft.dice.between(low[axis], high[axis]);
    if (is_free(draft, point, distance)) return point;
  }
  throw std::logic_error("no free place in " + draft.room.name);
}

void add_surfaces(Draft& draft) {
  Dice& dice = draft.dice;
  draft.add_material("floor", dice.between(0.1, 0.45));
  draft.add_material("ceiling", dice.between(0.6, 0.85));
  draft.add_material("furniture", dice.between(0.1, 0.6));
  const double wall = dice.between(0.35, 0.85);
  if (dice.chance(0.7)) return draft.add_material("wall", wall);
  draft.room.materials.push_back({"wall", {wall, dice.between(0.2, 0.8), dice.between(0.1, 0.7)}});
}

// Floor, ceiling and walls; "-y" leaves out the wall at y = 0.
Faces make_walls(const Vector& size, bool has_front) {
  const Point low = Point::Zero();
  Faces faces = make_box("room", "wall", low, size, has_front ? "+x-x+y-y" : "+x-x+y", Facing::inward);
  faces.push_back(make_box("room", "floor", low, size, "-z", Facing::inward)[0]);
  faces.push_back(make_box("room", "ceiling", low, size, "+z", Facing::inward)[0]);
  return faces;
}

// Windows in a row in the wall at y = 0.
struct WindowRow {
  double thickness = 0;  // of the walls, meters; 0: a sheet
  double sill = 0, head = 0;
  std::vector<std::array<double, 2>> openings;  // from x to x, ascending
};

WindowRow make_window_row(Dice& dice, const Vector& size) {
  WindowRow row;
  if (dice.chance(0.4)) row.thickness = dice.between(0.2, 0.4);
  row.sill = dice.chance(0.2) ? dice.between(0.1, 0.3) : dice.between(0.7, 1.1);
  row.head = size.z() - dice.between(0.2, 0.6);
  const double left = dice.between(0.2, 0.3 * size.x()), right = size.x() - dice.between(0.2, 0.3 * size.x());
  if (!dice.chance(0.3)) {
    row.openings = {{left, right}};
    return row;
  }
  const double middle = (left + right) / 2, pier = dice.between(0.1, 0.3);
  row.openings = {{left, middle - pier}, {middle + pier, right}};
  return row;
}

// The wall around the windows: strips in the plane of this y, from corner `low` to `high` of the wall's rectangle.
Faces make_window_wall(const WindowRow& row, const Point& low, const Point& high, Facing facing) {
  Faces faces;
  const auto add_strip = [&](double x0, double x1, double z0, double z1) {
    const Vector u = (x1 - x0) * Vector::UnitX(), v = (z1 - z0) * Vector::UnitZ();
    const bool to_room = facing == Facing::inward;
    faces.push_back(make_face("room", "wall", Point(x0, low.y(), z0), to_room ? v : u, to_room ? u : v));
  };
  add_strip(low.x(), high.x(), low.z(), row.sill);
  add_strip(low.x(), high.x(), row.head, high.z());
  double from = low.x();
  for (const auto& [left, right] : row.openings) {
    add_strip(from, left, row.sill, row.head);
    from = right;
  }
  add_strip(from, high.x(), row.sill, row.head);
  return faces;
}

// Outer faces of thick walls, and the reveals of their windows. With the inner faces they close a solid.
Faces make_outer_walls(const WindowRow& row, const Vector& size, double ground) {
  const double t = row.thickness;
  const Point low(-t, -t, ground), high(size.x() + t, size.y() + t, size.z() + t);
  Faces faces = make_box("room", "wall", low, high, "+x-x+y+z-z");
  const Faces facade = make_window_wall(row, low, Point(high.x(), low.y(), high.z()), Facing::outward);
  faces.insert(faces.end(), facade.begin(), facade.end());
  for (const auto& [left, right] : row.openings) {
    const Faces reveal =
        make_box("room", "wall", Point(left, -t, row.sill), Point(right, 0, row.head), "+x-x+z-z", Facing::inward);
    faces.insert(faces.end(), reveal.begin(), reveal.end());
  }
  return faces;
}

Faces make_panes(const WindowRow& row) {
  Faces faces;
  for (const auto& [left, right] : row.openings)
    faces.push_back(make_face("pane", "glass", Point(left, -row.thickness / 2, row.sill),
                              (row.head - row.sill) * Vector::UnitZ(), (right - left) * Vector::UnitX()));
  return faces;
}

// The height of the ground around the house.
constexpr double ground_level = -0.1;

// Level ground that extends to `reach` from the house: in front of the window wall only, or all around.
Faces make_lawn(const Point& low, const Point& high, double reach, bool all_around) {
  const double x0 = low.x() - reach, x1 = high.x() + reach, y0 = low.y() - reach, y1 = high.y() + reach;
  const auto part = [](double xa, double xb, double ya, double yb) {
    return make_face("ground", "ground", Point(xa, ya, ground_level), (xb - xa) * Vector::UnitX(),
                     (yb - ya) * Vector::UnitY());
  };
  Faces faces = {part(x0, x1, y0, low.y())};
  if (!all_around) return faces;
  faces.push_back(part(x0, x1, high.y(), y1));
  faces.push_back(part(x0, low.x(), low.y(), high.y()));
  faces.push_back(part(high.x(), x1, low.y(), high.y()));
  return faces;
}

// Triangles over 6 x 6 nodes: level around the house, hills farther away.
Faces make_hills(Dice& dice, double reach) {
  const double near = 20 + 0.05 * reach;
  const std::array<double, 6> lines = {-reach, -reach / 2, -near, near, reach / 2, reach};
  std::array<std::array<double, 6>, 6> height{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      const bool is_near = (i == 2 || i == 3) && (j == 2 || j == 3);
      height[i][j] = is_near ? -0.3 : dice.between(-0.3, reach / 20);
    }
  Faces faces;
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; j < 5; ++j) {
      const auto node = [&](std::size_t a, std::size_t b) { return Point(lines[a], lines[b], height[a][b]); };
      faces.push_back({"ground", "ground", {node(i, j), node(i + 1, j), node(i + 1, j + 1)}});
      faces.push_back({"ground", "ground", {node(i, j), node(i + 1, j + 1), node(i, j + 1)}});
    }
  return faces;
}

void add_daylight(Draft& draft) {
  Dice& dice = draft.dice;
  RoomDaylight day;
  const double altitude = dice.between(15, 65) * degree;
  const double azimuth = (dice.chance(0.15) ? dice.between(100, 260) : dice.between(-75, 75)) * degree;
  day.sun = Vector(std::sin(azimuth) * std::cos(altitude), -std::cos(azimuth) * std::cos(altitude), std::sin(altitude));
  day.sky = dice.pick<std::string>({"clear", "clear", "overcast", "perez", "perez", "uniform"});
  day.has_sun = day.sky != "overcast" && day.sky != "uniform" ? true : dice.chance(0.25);
  day.direct = dice.between(250, 700);
  day.diffuse = dice.between(60, 180);
  day.horizon_below = dice.chance(0.7) ? 0.2 : 0;
  draft.room.daylight = day;
}

// A table on four legs, turned about its center.
Faces make_table(Dice& dice, const Vector& size) {
  const double w = dice.between(0.9, 1.6), d = dice.between(0.6, 0.9), top = dice.between(0.68, 0.74);
  const double reach = std::hypot(w, d) / 2 + 0.05;
  const Point centre(dice.between(reach, size.x() - reach), dice.between(reach, size.y() - reach), 0);
  const Point low = centre - Vector(w / 2, d / 2, 0);
  Faces faces = make_box("table", "furniture", low + Vector(0, 0, top - 0.04), low + Vector(w, d, top));
  for (const double x : {0.02, w - 0.07})
    for (const double y : {0.02, d - 0.07}) {
      const Point leg = low + Vector(x, y, 0);
      const Faces sides = make_box("table", "furniture", leg, leg + Vector(0.05, 0.05, top - 0.04), "+x-x+y-y");
      faces.insert(faces.end(), sides.begin(), sides.end());
    }
  return turn_about(std::move(faces), centre, dice.chance(0.5) ? dice.between(-60, 60) : 0);
}

// A cupboard 1 cm to 10 cm in front of the wall at the largest y, away from the corners and below all lamps.
Faces make_cupboard(Dice& dice, const Vector& size) {
  const double w = dice.between(0.6, 1.4), d = dice.between(0.35, 0.5), h = dice.between(0.8, size.z() - 0.9);
  const double x = dice.between(0.1, size.x() - w - 0.1), y = size.y() - d - dice.between(0.01, 0.1);
  return make_box("cupboard", "furniture", Point(x, y, 0), Point(x + w, y + d, h), "+x-x+y-y+z");
}

// Tables and a cupboard. Each stands at the first of twenty random places that is clear of other bodies.
void add_furniture(Draft& draft) {
  const int tables = draft.dice.whole(1, 2);
  for (int k = 0; k <= tables; ++k)
    for (int attempt = 0; attempt < 20; ++attempt) {
      const Vector& size = draft.room.size;
      const Faces faces = k < tables ? make_table(draft.dice, size) : make_cupboard(draft.dice, size);
      if (!fits(draft, faces)) continue;
      draft.add_body(faces);
      break;
    }
}

void add_overhang(Draft& draft, const WindowRow& row) {
  Dice& dice = draft.dice;
  const double depth = dice.between(0.8, 2.5), bottom = row.head + dice.between(0.05, 0.2);
  const Point low(row.openings.front()[0] - dice.between(0.1, 1), -row.thickness - depth, bottom);
  const Point high(row.openings.back()[1] + dice.between(0.1, 1), -row.thickness, bottom + 0.15);
  draft.add(make_box("overhang", "facade", low, high, "+x-x-y+z-z"));
}

// Houses in front of the window, side by side from left to right.
void add_neighbors(Draft& draft, const WindowRow& row) {
  Dice& dice = draft.dice;
  const int houses = dice.whole(1, 3);
  double x = dice.between(-15, -2);
  for (int k = 0; k < houses; ++k) {
    const double w = dice.between(5, 12), d = dice.between(5, 12), h = dice.between(3, 18);
    const double y = -row.thickness - dice.between(5, 18);
    draft.add(make_box("neighbour", "facade", Point(x, y - d, ground_level), Point(x + w, y, h), "+x-x+y-y+z"));
    x += w + dice.between(0.5, 6);
  }
}

// Sheets in front of the windows: horizontal slats tilted down to the outside, or upright ones.
void add_slats(Draft& draft, const WindowRow& row) {
  Dice& dice = draft.dice;
  const double width = dice.between(0.06, 0.25), pitch = width * dice.between(0.8, 1.3);
  const double tilt = dice.between(0, 50) * degree, y = -row.thickness - dice.between(0.05, 0.2);
  const double left = row.openings.front()[0] - 0.05, right = row.openings.back()[1] + 0.05;
  if (dice.chance(0.7)) {
    const Vector across(0, -width * std::cos(tilt), -width * std::sin(tilt));
    for (double z = row.sill; z < row.head + pitch / 2; z += pitch)
      draft.add({make_face("slats", "slat", Point(left, y, z), across, (right - left) * Vector::UnitX())});
  } else {
    const Vector across(width * std::sin(tilt), -width * std::cos(tilt), 0);
    for (double x = left; x < right + pitch / 2; x += pitch)
      draft.add({make_face("slats", "slat", Point(x, y, row.sill - 0.05), across,
                           (row.head - row.sill + 0.1) * Vector::UnitZ())});
  }
}

void add_daylight_parts(Draft& draft) {
  Dice& dice = draft.dice;
  const std::string& kind = draft.room.kind;
  const Vector& size = draft.room.size;
  add_daylight(draft);
  draft.add_material("ground", dice.between(0.1, 0.35));
  draft.add_material("facade", dice.between(0.2, 0.6));
  draft.add_material("slat", dice.between(0.2, 0.8));
  draft.room.materials.push_back({"glass", {}, 0, dice.between(0.55, 0.88)});
  const WindowRow row = make_window_row(dice, size);
  draft.add(make_walls(size, false));
  draft.add(make_window_wall(row, Point::Zero(), Point(size.x(), 0, size.z()), Facing::inward));
  if (row.thickness > 0) draft.add(make_outer_walls(row, size, ground_level));
  draft.add(make_panes(row));
  const double t = row.thickness;
  const Point low(-t, -t, 0), high(size.x() + t, size.y() + t, 0);
  if (kind == "terrain" && dice.chance(0.4))
    draft.add(make_hills(dice, dice.log_between(100, 300)));
  else if (kind == "terrain")
    draft.add(make_lawn(low, high, dice.log_between(100, 300), true));
  else
    draft.add(make_lawn(low, high, dice.log_between(15, 80), dice.chance(0.5)));
  if (kind == "overhang") add_overhang(draft, row);
  if (kind == "neighbors") add_neighbors(draft, row);
  if (kind == "louvres") add_slats(draft, row);
  if (kind == "furniture" || dice.chance(0.15)) add_furniture(draft);
}

// A flat box that emits downward, or upward.
void add_panel(Draft& draft, const Point& centre, double w, double d, bool emits_up = false) {
  const Point low = centre - Vector(w / 2, d / 2, 0.02), high = centre + Vector(w / 2, d / 2, 0.02);
  Faces faces = make_box("lamp", "housing", low, high);
  faces[emits_up ? 4 : 5].material = "lamp";
  draft.add_body(faces);
}

// A place for a lamp at this distance below the ceiling, at least 20 cm from all bodies.
Point find_lamp_place(Draft& draft, double margin, double below) {
  const Point low(margin, margin, draft.room.size.z() - below);
  return find_place(draft, low, Point(draft.room.size.x() - margin, draft.room.size.y() - margin, low.z()), 0.2);
}

void add_panels(Draft& draft) {
  Dice& dice = draft.dice;
  const int columns = dice.whole(1, 3);
  const double below = dice.between(0.05, 0.7);
  const bool emits_up = below > 0.3 && dice.chance(0.4);
  const double w = dice.between(0.2, 0.6), d = dice.between(0.2, 1.4);
  for (int k = 0; k < columns; ++k) {
    const double x = draft.room.size.x() * (k + 0.5) / columns;
    add_panel(draft, Point(x, draft.room.size.y() / 2, draft.room.size.z() - below), w, d, emits_up);
  }
}

RoomLuminaire make_spot(Draft& draft, const Point& target) {
  Dice& dice = draft.dice;
  RoomLuminaire lamp{.kind = "spot", .position = find_lamp_place(draft, 0.3, dice.between(0.05, 0.5))};
  lamp.aim = (target - lamp.position).normalized();
  lamp.watts = dice.between(5, 60);
  lamp.beam_angle = dice.between(10, 50);
  lamp.field_angle = lamp.beam_angle * dice.between(1.4, 2.2);
  return lamp;
}

void add_spots(Draft& draft) {
  const int spots = draft.dice.whole(1, 4);
  for (int k = 0; k < spots; ++k) {
    Point target = find_lamp_place(draft, 0.2, 0.5);
    target.z() = draft.dice.chance(0.6) ? 0 : draft.dice.between(0.3, 1.5);
    draft.room.luminaires.push_back(make_spot(draft, target));
  }
}

RoomLuminaire make_luminaire(Draft& draft) {
  Dice& dice = draft.dice;
  RoomLuminaire lamp{.kind = dice.pick<std::string>({"point", "sphere", "ies"})};
  lamp.position = find_lamp_place(draft, 0.4, dice.between(0.25, 0.7));
  if (lamp.kind == "sphere") lamp.radius = dice.between(0.03, 0.15);
  lamp.watts = lamp.kind == "ies" ? dice.between(800, 5000) : dice.between(5, 40);
  return lamp;
}

void add_luminaires(Draft& draft) {
  const int count = draft.dice.whole(1, 3);
  for (int k = 0; k < count; ++k) draft.room.luminaires.push_back(make_luminaire(draft));
}

// Mirrors 1 to 3 cm in front of two walls. In every other room, a spot is aimed at the center of one.
void add_mirrors(Draft& draft) {
  Dice& dice = draft.dice;
  const Vector& size = draft.room.size;
  draft.room.materials.push_back({"mirror", {}, 0, 0, dice.between(0.8, 0.95)});
  const double gap = dice.between(0.01, 0.03), w = dice.log_between(0.06, 2), h = dice.log_between(0.1, 1.6);
  const double x = dice.between(0.1, size.x() - w - 0.1), z = dice.between(0.1, size.z() - h - 0.1);
  const Point corner(x, size.y() - gap, z);
  draft.add_body({make_face("mirror", "mirror", corner, w * Vector::UnitX(), h * Vector::UnitZ())});
  if (dice.chance(0.6)) {
    const double length = dice.between(0.5, 2), from = dice.between(0.1, size.y() - length - 0.1);
    draft.add_body(
        {make_face("mirror", "mirror", Point(gap, from, 0.5), length * Vector::UnitY(), 1.2 * Vector::UnitZ())});
  }
  if (dice.chance(0.5)) add_panels(draft);
  if (dice.chance(0.5))
    draft.room.luminaires.push_back(make_spot(draft, corner + Vector(w / 2, 0, h / 2)));
  else
    add_luminaires(draft);
}

void add_many_lamps(Draft& draft) {
  Dice& dice = draft.dice;
  const Vector& size = draft.room.size;
  const int columns = dice.whole(3, 6), rows = dice.whole(4, 6);
  const std::string kind = dice.pick<std::string>({"panel", "panel", "point", "sphere", "ies"});
  const double below = kind == "panel" ? dice.between(0.05, 0.3) : dice.between(0.2, 0.6);
  const double watts = dice.between(1, 5);
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const Point place(size.x() * (i + 0.5) / columns, size.y() * (j + 0.5) / rows, size.z() - below);
      if (kind == "panel")
        add_panel(draft, place, 0.2, 0.2);
      else
        draft.room.luminaires.push_back({.kind = kind,
                                         .position = place,
                                         .watts = kind == "ies" ? 100 * watts : watts,
                                         .radius = kind == "sphere" ? 0.05 : 0});
    }
}

// A panel above a grid of upright sheets.
void add_egg_crate(Draft& draft) {
  Dice& dice = draft.dice;
  const double side = dice.between(0.4, 0.7), height = dice.between(0.05, 0.1);
  const int cells = dice.whole(4, 9);
  const Point centre = find_lamp_place(draft, side, 0.07);
  add_panel(draft, centre, side, side);
  const Point low = centre - Vector(side / 2, side / 2, 0.04 + height);
  const double pitch = side / cells;
  for (int k = 0; k <= cells; ++k) {
    draft.add({make_face("crate", "housing", low + k * pitch * Vector::UnitX(), side * Vector::UnitY(),
                         height * Vector::UnitZ()),
               make_face("crate", "housing", low + k * pitch * Vector::UnitY(), side * Vector::UnitX(),
                         height * Vector::UnitZ())});
  }
}

// A wall with a doorway across the room; the lamp hangs on one side of it.
void add_dividing_wall(Draft& draft) {
  Dice& dice = draft.dice;
  const Vector& size = draft.room.size;
  const double x = size.x() * dice.between(0.45, 0.6), door = dice.between(0.1, size.y() - 1.1);
  const std::vector<std::array<double, 3>> parts = {{0, door, 0}, {door + 0.9, size.y(), 0}, {door, door + 0.9, 2.1}};
  for (const auto& [from, to, bottom] : parts) {
    const std::string ends = bottom > 0 ? "-z" : from > 0 ? "-y" : "+y";
    draft.add_body(make_box("partition", "wall", Point(x, from, bottom), Point(x + 0.1, to, size.z()), "+x-x" + ends));
  }
  add_panel(draft, Point(x / 2, size.y() * dice.between(0.3, 0.7), size.z() - 0.1), 0.6, dice.between(0.3, 1.2));
}

void add_lamp_parts(Draft& draft) {
  Dice& dice = draft.dice;
  const std::string& kind = draft.room.kind;
  draft.add_material("lamp", 0.5, dice.log_between(10, 100));
  draft.add_material("housing", dice.between(0.3, 0.8));
  draft.add(make_walls(draft.room.size, true));
  if (kind == "panels" || kind == "furnished") add_panels(draft);
  if (kind == "spots") add_spots(draft);
  if (kind == "luminaires") add_luminaires(draft);
  if (kind == "mirrors") add_mirrors(draft);
  if (kind == "many_lamps") add_many_lamps(draft);
  if (kind == "egg_crate") add_egg_crate(draft);
  if (kind == "two_rooms") add_dividing_wall(draft);
  if (kind == "furnished" || dice.chance(0.2)) add_furniture(draft);
}

// An upright rectangle, turned about its center, that stands below the lamps: the first of twenty that is clear of
// other bodies. Without such a place there is none.
void add_upright(Draft& draft, const RoomMaterial& material) {
  Dice& dice = draft.dice;
  const Vector& size = draft.room.size;
  for (int attempt = 0; attempt < 20; ++attempt) {
    const double w = dice.between(0.4, 1.2), bottom = dice.between(0.02, 0.4);
    const Point centre(dice.between(0.65, size.x() - 0.65), dice.between(0.65, size.y() - 0.65), bottom);
    const Vector height = dice.between(0.5, size.z() - 0.9 - bottom) * Vector::UnitZ();
    const Faces faces = turn_about(
        {make_face(material.name, material.name, centre - w / 2 * Vector::UnitX(), w * Vector::UnitX(), height)},
        centre, dice.between(-180, 180));
    if (!fits(draft, faces)) continue;
    draft.add_body(faces);
    draft.room.materials.push_back(material);
    return;
  }
}

// A colored pane, a colored mirror and a sheet in the room, each with some probability, and often a tinted window
// and a textured floor.
void add_optics(Draft& draft) {
  Dice& dice = draft.dice;
  const auto tint = [&] {
    return std::array<double, 3>{dice.between(0.3, 1), dice.between(0.3, 1), dice.between(0.3, 1)};
  };
  for (RoomMaterial& material : draft.room.materials)
    if (material.name == "glass" && dice.chance(0.6)) material.tint = tint();
  if (dice.chance(0.6))
    add_upright(draft, {.name = "color_pane", .transmittance = dice.between(0.6, 0.9), .tint = tint()});
  if (dice.chance(0.4))
    add_upright(draft, {.name = "color_mirror", .specular_reflectance = dice.between(0.7, 0.95), .tint = tint()});
  if (dice.chance(0.6)) {
    const double back = dice.between(0.2, 0.5);
    add_upright(draft,
                {.name = "sheet", .reflectance = {back, back, back}, .diffuse_transmittance = dice.between(0.2, 0.45)});
  }
  for (RoomMaterial& material : draft.room.materials)
    if (material.name == "floor") material.has_texture = dice.chance(0.5);
}

// Nine sensors on a work plane, four near walls, one that faces a distant wall, one near the ceiling that faces down.
void add_sensors(Draft& draft) {
  const Vector size = draft.room.size;
  constexpr double margin = 0.3, near = 0.05;
  const double plane = draft.dice.between(0.76, 0.9);
  const auto add = [&](const Point& low, const Point& high, const Vector& normal) {
    draft.room.sensors.push_back({find_place(draft, low, high, 0.05), normal});
  };
  const Point low(margin, margin, margin), high = size - low;
  for (int k = 0; k < 9; ++k) add(Point(low.x(), low.y(), plane), Point(high.x(), high.y(), plane), Vector::UnitZ());
  add(Point(near, low.y(), low.z()), Point(near, high.y(), high.z()), Vector::UnitX());
  add(Point(size.x() - near, low.y(), low.z()), Point(size.x() - near, high.y(), high.z()), -Vector::UnitX());
  add(Point(low.x(), near, low.z()), Point(high.x(), near, high.z()), Vector::UnitY());
  add(Point(low.x(), size.y() - near, low.z()), Point(high.x(), size.y() - near, high.z()), -Vector::UnitY());
  const double angle = draft.dice.between(0, 360) * degree;
  add(Point(low.x(), low.y(), 1.2), Point(high.x(), high.y(), 1.2), Vector(std::cos(angle), std::sin(angle), 0));
  add(Point(low.x(), low.y(), size.z() - near), Point(high.x(), high.y(), size.z() - near), -Vector::UnitZ());
}

std::string make_name(const std::string& kind, std::size_t number) {
  return kind + (number < 10 ? "_0" : "_") + std::to_string(number);
}

}  // namespace

std::vector<std::string> daylight_kinds() {
  return {"lawn", "overhang", "neighbors", "terrain", "furniture", "louvres"};
}

std::vector<std::string> lamp_kinds() {
  return {"panels", "spots", "luminaires", "mirrors", "many_lamps", "egg_crate", "two_rooms", "furnished"};
}

RandomRoom make_random_room(const std::string& kind, std::size_t number, std::uint64_t seed, RoomOptics optics) {
  const std::vector<std::string> daylight = daylight_kinds(), lamps = lamp_kinds();
  const auto by_day = std::find(daylight.begin(), daylight.end(), kind);
  const auto by_lamp = std::find(lamps.begin(), lamps.end(), kind);
  assert(by_day != daylight.end() || by_lamp != lamps.end());
  const auto place = static_cast<std::uint64_t>(by_day != daylight.end() ? by_day - daylight.begin()
                                                                         : 100 + (by_lamp - lamps.begin()));
  Draft draft{{.name = make_name(kind, number), .kind = kind}, Dice(hash({seed, place, number})), {}};
  Dice& dice = draft.dice;
  draft.room.size = Vector(dice.between(3, 7), dice.between(3, 7), dice.between(2.4, 3.4));
  if (dice.chance(0.5)) draft.room.turn = dice.between(-180, 180);
  draft.room.millimetres = dice.chance(0.3);
  add_surfaces(draft);
  if (by_day != daylight.end())
    add_daylight_parts(draft);
  else
    add_lamp_parts(draft);
  if (optics == RoomOptics::mixed) add_optics(draft);
  add_sensors(draft);
  return draft.room;
}

}  // namespace patchlight::test
