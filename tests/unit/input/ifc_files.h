#pragma once

#include "patchlight/base/geometry.h"

#include <array>
#include <sstream>
#include <string>
#include <vector>

// IFC files with boxes, written in several ways. Lengths are in the file's unit.
namespace patchlight::test {

/// Representation of a body.
enum class IfcWay { upward, across, brep, triangulated, polygonal, clipped, mapped };

/// Entities of an IFC file with a project, a building, one storey and no elements at first.
class IfcFile {
 public:
  explicit IfcFile(std::string schema = "IFC4", const std::string& unit = "IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.)",
                   const std::string& north = "$")
      : schema_(std::move(schema)) {
    origin_ = add("IFCAXIS2PLACEMENT3D(" + point(Point(0, 0, 0)) + ",$,$)");
    placement_ = add("IFCLOCALPLACEMENT($," + origin_ + ")");
    const std::string direction = north == "$" ? north : add("IFCDIRECTION(" + north + ")");
    context_ = add("IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5," + origin_ + "," + direction + ")");
    const std::string units = add("IFCUNITASSIGNMENT((" + add(unit) + "))");
    const std::string project = add("IFCPROJECT('project',$,'p',$,$,$,$,(" + context_ + ")," + units + ")");
    const std::string building = add("IFCBUILDING('building',$,'b',$,$," + placement_ + ",$,$,.ELEMENT.,$,$,$)");
    storey_ = add("IFCBUILDINGSTOREY('storey',$,'Level 1',$,$," + placement_ + ",$,$,.ELEMENT.,0.)");
    add("IFCRELAGGREGATES('r1',$,$,$," + project + ",(" + building + "))");
    add("IFCRELAGGREGATES('r2',$,$,$," + building + ",(" + storey_ + "))");
  }

  /// Its number: "#12".
  std::string add(const std::string& entity) {
    const std::string number = "#" + std::to_string(++last_);
    text_ += number + "=" + entity + ";\n";
    return number;
  }

  std::string point(const Point& p) { return add("IFCCARTESIANPOINT((" + numbers(p) + "))"); }

  /// A closed outline in a plane.
  std::string outline(const std::vector<Eigen::Vector2d>& corners) {
    std::string list;
    for (const Eigen::Vector2d& p : corners)
      list += add("IFCCARTESIANPOINT((" + number(p.x()) + "," + number(p.y()) + "))") + ",";
    return add("IFCPOLYLINE((" + list + list.substr(0, list.find(',')) + "))");
  }

  /// A profile in the plane of x and z, extruded from `y` over `depth` against z x x, which is y.
  std::string across(const std::string& profile, double y, double depth) {
    const std::string place = add("IFCAXIS2PLACEMENT3D(" + point(Point(0, y + depth, 0)) + "," + direction(0, -1, 0) +
                                  "," + direction(1, 0, 0) + ")");
    return add("IFCEXTRUDEDAREASOLID(" + profile + "," + place + "," + direction(0, 0, 1) + "," + number(depth) + ")");
  }

  std::string box(const Box& box, IfcWay way) {
    switch (way) {
      case IfcWay::upward:
        return upward(box);
      case IfcWay::across:
        return across(closed_profile(rectangle(box)), box.min().y(), box.sizes().y());
      case IfcWay::brep:
        return brep(box);
      case IfcWay::triangulated:
        return triangulated(box);
      case IfcWay::polygonal:
        return polygonal(box);
      case IfcWay::clipped:
        return clipped(box);
      case IfcWay::mapped:
        return mapped(upward(box));
    }
    return {};
  }

  std::string closed_profile(const std::vector<Eigen::Vector2d>& corners) {
    return add("IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$," + outline(corners) + ")");
  }

  /// Returns the number of an element of one body.
  std::string element(const std::string& kind, const std::string& name, const std::string& body) {
    const bool is_old = schema_ == "IFC2X3";
    const std::string tail = kind == "IFCWINDOW" ? (is_old ? ",$,$,$" : ",$,$,$,$,$,$") : is_old ? ",$" : ",$,$";
    const std::string number =
        add(kind + "('" + identifier() + "',$,'" + name + "',$,$," + placement_ + "," + shape(body) + tail + ")");
    if (kind != "IFCOPENINGELEMENT")
      add("IFCRELCONTAINEDINSPATIALSTRUCTURE('" + identifier() + "',$,$,$,(" + number + ")," + storey_ + ")");
    return number;
  }

  void cut(const std::string& element_number, const std::string& body) {
    const std::string opening = element("IFCOPENINGELEMENT", "opening", body);
    add("IFCRELVOIDSELEMENT('" + identifier() + "',$,$,$," + element_number + "," + opening + ")");
  }

  void space(const std::string& name, const std::string& long_name, const std::string& body) {
    const std::string number =
        add("IFCSPACE('" + identifier() + "',$,'" + name + "',$,$," + placement_ + "," + shape(body) + "," +
            (long_name.empty() ? "$" : "'" + long_name + "'") + ",.ELEMENT.,.INTERNAL.,$)");
    add("IFCRELAGGREGATES('" + identifier() + "',$,$,$," + storey_ + ",(" + number + "))");
  }

  /// A surface style with the file's value of `transparency`.
  std::string style(const std::string& name, const std::string& color, const std::string& transparency) {
    const std::string rendering = add("IFCSURFACESTYLERENDERING(" + add("IFCCOLOURRGB($," + color + ")") + "," +
                                      transparency + ",$,$,$,$,$,$,.FLAT.)");
    return add("IFCSURFACESTYLE('" + name + "',.BOTH.,(" + rendering + "))");
  }

  /// Gives a body a style.
  void paint(const std::string& body, const std::string& style) {
    add("IFCSTYLEDITEM(" + body + ",(" + style + "),$)");
  }

  /// Gives an element a material that has a style.
  void make_of(const std::string& element_number, const std::string& style) {
    const std::string material = add("IFCMATERIAL('stuff',$,$)");
    const std::string item = add("IFCSTYLEDITEM($,(" + style + "),$)");
    const std::string drawn = add("IFCSTYLEDREPRESENTATION(" + context_ + ",'Style','Material',(" + item + "))");
    add("IFCMATERIALDEFINITIONREPRESENTATION($,$,(" + drawn + ")," + material + ")");
    add("IFCRELASSOCIATESMATERIAL('" + identifier() + "',$,$,$,(" + element_number + ")," + material + ")");
  }

  std::string text() const {
    return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
           "FILE_SCHEMA(('" +
           schema_ + "'));\nENDSEC;\nDATA;\n" + text_ + "ENDSEC;\nEND-ISO-10303-21;\n";
  }

 private:
  static std::string number(double value) {
    std::ostringstream out;
    out.precision(15);
    out << std::showpoint << value;
    return out.str();
  }

  static std::string numbers(const Point& p) { return number(p.x()) + "," + number(p.y()) + "," + number(p.z()); }

  std::string direction(double x, double y, double z) { return add("IFCDIRECTION((" + numbers(Point(x, y, z)) + "))"); }

  std::string identifier() {
    std::string digits = std::to_string(++identifiers_);
    return std::string(22 - digits.size(), '0') + digits;
  }

  std::string shape(const std::string& body) {
    return add("IFCPRODUCTDEFINITIONSHAPE($,$,(" +
               add("IFCSHAPEREPRESENTATION(" + context_ + ",'Body','SolidModel',(" + body + "))") + "))");
  }

  // The outline of a box seen along y.
  static std::vector<Eigen::Vector2d> rectangle(const Box& box) {
    const Point& a = box.min();
    const Point& b = box.max();
    return {{a.x(), a.z()}, {b.x(), a.z()}, {b.x(), b.z()}, {a.x(), b.z()}};
  }

  std::string upward(const Box& box) {
    const Point middle = box.center();
    const std::string profile =
        add("IFCRECTANGLEPROFILEDEF(.AREA.,$,$," + number(box.sizes().x()) + "," + number(box.sizes().y()) + ")");
    const std::string place =
        add("IFCAXIS2PLACEMENT3D(" + point(Point(middle.x(), middle.y(), box.min().z())) + ",$,$)");
    return add("IFCEXTRUDEDAREASOLID(" + profile + "," + place + "," + direction(0, 0, 1) + "," +
               number(box.sizes().z()) + ")");
  }

  // Corner k has the larger x, y and z where bits 1, 2 and 4 of k are set.
  static std::array<Point, 8> corners(const Box& box) {
    std::array<Point, 8> all;
    for (unsigned k = 0; k < 8; ++k)
      for (unsigned axis = 0; axis < 3; ++axis)
        all[k][axis] = (k >> axis & 1U) != 0 ? box.max()[axis] : box.min()[axis];
    return all;
  }

  // Outward.
  static constexpr std::array<std::array<int, 4>, 6> quads = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};

  std::string brep(const Box& box) {
    std::array<std::string, 8> points;
    for (std::size_t k = 0; k < 8; ++k) points[k] = point(corners(box)[k]);
    std::string faces;
    for (const auto& [a, b, c, d] : quads) {
      const std::string loop =
          add("IFCPOLYLOOP((" + points[a] + "," + points[b] + "," + points[c] + "," + points[d] + "))");
      faces += (faces.empty() ? "" : ",") + add("IFCFACE((" + add("IFCFACEOUTERBOUND(" + loop + ",.T.)") + "))");
    }
    return add("IFCFACETEDBREP(" + add("IFCCLOSEDSHELL((" + faces + "))") + ")");
  }

  std::string point_list(const Box& box) {
    std::string list;
    for (const Point& p : corners(box)) list += (list.empty() ? "(" : ",(") + numbers(p) + ")";
    return add("IFCCARTESIANPOINTLIST3D((" + list + "))");
  }

  std::string triangulated(const Box& box) {
    std::string list;
    for (const auto& [a, b, c, d] : quads)
      for (const auto& [i, j, k] : {std::array{a, b, c}, std::array{a, c, d}})
        list += (list.empty() ? "(" : ",(") + std::to_string(i + 1) + "," + std::to_string(j + 1) + "," +
                std::to_string(k + 1) + ")";
    return add("IFCTRIANGULATEDFACESET(" + point_list(box) + ",$,.T.,(" + list + "),$)");
  }

  std::string polygonal(const Box& box) {
    std::string list;
    for (const auto& quad : quads) {
      std::string face;
      for (const int k : quad) face += (face.empty() ? "" : ",") + std::to_string(k + 1);
      list += (list.empty() ? "" : ",") + add("IFCINDEXEDPOLYGONALFACE((" + face + "))");
    }
    return add("IFCPOLYGONALFACESET(" + point_list(box) + ",.T.,(" + list + "),$)");
  }

  // Twice as high, cut by a plane.
  std::string clipped(const Box& box) {
    Box high = box;
    high.max().z() += box.sizes().z();
    const std::string plane =
        add("IFCPLANE(" +
            add("IFCAXIS2PLACEMENT3D(" + point(box.max()) + "," + direction(0, 0, 1) + "," + direction(1, 0, 0) + ")") +
            ")");
    return add("IFCBOOLEANCLIPPINGRESULT(.DIFFERENCE.," + upward(high) + "," +
               add("IFCHALFSPACESOLID(" + plane + ",.F.)") + ")");
  }

  std::string mapped(const std::string& body) {
    const std::string drawn = add("IFCSHAPEREPRESENTATION(" + context_ + ",'Body','SolidModel',(" + body + "))");
    const std::string map = add("IFCREPRESENTATIONMAP(" + origin_ + "," + drawn + ")");
    const std::string target = add("IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$," + point(Point(0, 0, 0)) + ",$,$)");
    return add("IFCMAPPEDITEM(" + map + "," + target + ")");
  }

  std::string schema_;
  std::string text_;
  std::string origin_;
  std::string placement_;
  std::string context_;
  std::string storey_;
  int last_ = 0;
  int identifiers_ = 0;
};

}  // namespace patchlight::test
