#include "input/ifc_voids.h"

#include "patchlight/input/read_scene.h"

#include "input/joined_rings.h"
#include "model_files.h"

namespace patchlight::ifc_voids_test {
namespace {

// A plate of 5 m x 3 m, 0.1 m thick, with what `profile` says cut out of it. Numbers from #200 on are its own.
std::string plate(const std::string& profile) {
  return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
         "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n"
         "#1=IFCCARTESIANPOINT((0.,0.,0.));\n#2=IFCAXIS2PLACEMENT3D(#1,$,$);\n#3=IFCLOCALPLACEMENT($,#2);\n"
         "#4=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model; with (all)',3,1.E-5,#2,$);\n"
         "#5=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n#6=IFCUNITASSIGNMENT((#5));\n"
         "#7=IFCPROJECT('project',#21,'p',$,$,$,$,(#4),#6);\n"
         "#8=IFCSITE('site',#21,'s',$,$,#3,$,$,.ELEMENT.,$,$,$,$,$);\n#9=IFCRELAGGREGATES('a',#21,$,$,#7,(#8));\n"
         "#10=IFCPRODUCTDEFINITIONSHAPE($,$,(#11));\n#11=IFCSHAPEREPRESENTATION(#4,'Body','SweptSolid',(#12));\n"
         "#12=IFCEXTRUDEDAREASOLID(#13,#2,#15,0.1);\n#15=IFCDIRECTION((0.,0.,1.));\n"
         "#14=IFCBUILDINGELEMENTPROXY('plate',#21,'plate',$,$,#3,#10,$,$);\n"
         "#16=IFCRELCONTAINEDINSPATIALSTRUCTURE('c',#21,$,$,(#14),#8);\n"
         "#21=IFCOWNERHISTORY(#22,#25,$,.ADDED.,$,$,$,0);\n#22=IFCPERSONANDORGANIZATION(#23,#24,$);\n"
         "#23=IFCPERSON($,'','',$,$,$,$,$);\n#24=IFCORGANIZATION($,'',$,$,$);\n#25=IFCAPPLICATION(#24,'1','t','t');\n"
         "#100=IFCCARTESIANPOINT((0.,0.));\n#101=IFCCARTESIANPOINT((5.,0.));\n#102=IFCCARTESIANPOINT((5.,3.));\n"
         "#103=IFCCARTESIANPOINT((0.,3.));\n#104=IFCPOLYLINE((#100,#101,#102,#103,#100));\n" +
         profile + "ENDSEC;\nEND-ISO-10303-21;\n";
}

// A window of 1 m x 2 m, as clockwise as the outline is not, and a triangular one of 0.5 m^2 that runs the other way.
const std::string two_voids =
    "#200=IFCCARTESIANPOINT((1.,0.5));\n#201=IFCCARTESIANPOINT((1.,2.5));\n#202=IFCCARTESIANPOINT((2.,2.5));\n"
    "#203=IFCCARTESIANPOINT((2.,0.5));\n#204=IFCPOLYLINE((#200,#201,#202,#203,#200));\n"
    "#205=IFCCARTESIANPOINT((3.,1.));\n#206=IFCCARTESIANPOINT((4.,1.));\n#207=IFCCARTESIANPOINT((3.,2.));\n"
    "#208=IFCPOLYLINE((#205,#206,#207,#205));\n#13=IFCARBITRARYPROFILEDEFWITHVOIDS(.AREA.,$,#104,(#204,#208));\n";

const std::string round_void =
    "#200=IFCCARTESIANPOINT((2.,1.5));\n#201=IFCAXIS2PLACEMENT2D(#200,$);\n#202=IFCCIRCLE(#201,0.5);\n"
    "#13=IFCARBITRARYPROFILEDEFWITHVOIDS(.AREA.,$,#104,(#202));\n";

// The divergence theorem; a seam that is walked both ways adds nothing.
double volume_of(const Scene& scene) {
  double volume = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> points = corner_points(scene, p);
    for (std::size_t k = 1; k + 1 < points.size(); ++k) volume += points[0].dot(points[k].cross(points[k + 1])) / 6;
  }
  return volume;
}

double area_of(const Scene& scene) {
  double area = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> points = corner_points(scene, p);
    Vector twice = Vector::Zero();
    for (std::size_t k = 1; k + 1 < points.size(); ++k)
      twice += (points[k] - points[0]).cross(points[k + 1] - points[0]);
    area += twice.norm() / 2;
  }
  return area;
}

class IfcVoids : public ModelFiles {};

double area_of_walk(const std::vector<std::vector<Eigen::Vector2d>>& rings, const std::vector<RingCorner>& walk) {
  double twice = 0;
  for (std::size_t k = 0; k < walk.size(); ++k) {
    const auto& [ra, a] = walk[k];
    const auto& [rb, b] = walk[(k + 1) % walk.size()];
    twice += rings[ra][a].x() * rings[rb][b].y() - rings[ra][a].y() * rings[rb][b].x();
  }
  return twice / 2;
}

// A square of 7 with nine windows of 1 close together: all are joined, and the walk's area is what they leave.
TEST(JoinedRings, ReachHolesBehindOthers) {
  using Ring = std::vector<Eigen::Vector2d>;
  const auto square = [](double x, double y, double edge) {
    return Ring{{x, y}, {x + edge, y}, {x + edge, y + edge}, {x, y + edge}};
  };
  std::vector<Ring> rings = {square(0, 0, 7)};
  for (const int k : {4, 0, 1, 2, 3, 5, 6, 7, 8}) rings.push_back(square(1.9 + 1.1 * (k % 3), 1.9 + 1.1 * (k / 3), 1));
  const auto walk = joined_rings(rings);
  ASSERT_TRUE(walk.has_value());
  EXPECT_NEAR(area_of_walk(rings, *walk), 49 - 9, 1e-12);
  EXPECT_EQ(walk->size(), 4U + 9 * (4 + 2));
  EXPECT_FALSE(joined_rings({square(0, 0, 1), Ring{{0, 0}, {1, 0}}}).has_value());
}

// Volume h (A - sum of voids), surface twice that area and h times all rims. Coordinates are single precision.
TEST_F(IfcVoids, AreCutOutOfWhatIsExtruded) {
  const Scene scene = read_scene(write("plate.ifc", plate(two_voids)));
  const double area = 5 * 3 - 2 - 0.5;
  const double rims = 16 + 6 + 2 + std::sqrt(2.0);
  EXPECT_NEAR(std::abs(volume_of(scene)), 0.1 * area, 1e-5);
  EXPECT_NEAR(area_of(scene), 2 * area + 0.1 * rims, 1e-5);
  EXPECT_EQ(scene.polygons.size(), 2U + 4 + 4 + 3);
}

// Spaces after commas, names with a number sign, and comments, as other programs write them.
TEST_F(IfcVoids, AreFoundHoweverTheFileIsSpaced) {
  std::string text = plate(two_voids);
  const std::string tight = "(.AREA.,$,#104,(#204,#208))";
  text.replace(text.find(tight), tight.size(), "( .AREA. , 'No. #7, (left)' , #104 , ( #204 , #208 ) )");
  EXPECT_NEAR(std::abs(volume_of(read_scene(write("plate.ifc", text)))), 0.1 * 12.5, 1e-5);
  text.replace(text.find("#200="), 5, "/* it isn't; see #9000 */ #200=");
  const JoinedVoids found = with_joined_voids(text);
  EXPECT_EQ(found.joined, 1U);
  EXPECT_NE(found.text.find("#9001=IFCPOLYLINE"), std::string::npos);
}

// Linear time: a statement without an equal sign is not looked for beyond its end.
TEST_F(IfcVoids, OfManyDamagedStatementsEndSoon) {
  std::string text;
  for (int k = 0; k < 400'000; ++k) text += "#1;";
  EXPECT_EQ(with_joined_voids(text).text.size(), text.size());
}

TEST_F(IfcVoids, WithCurvesStayAndAreNamed) {
  const JoinedVoids found = with_joined_voids(plate(round_void));
  EXPECT_EQ(found.text, plate(round_void));
  EXPECT_EQ(found.left, 1U);
  const Scene scene = read_scene(write("plate.ifc", plate(round_void)));
  EXPECT_TRUE(any_contains(scene.notes, "1 profile has voids that are no polygons within it, which are not cut"));
}

TEST_F(IfcVoids, LeaveEverythingElseAsItIs) {
  const std::string closed = plate("#13=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#104);\n");
  EXPECT_EQ(with_joined_voids(closed).text, closed);
  for (const std::string& damaged :
       {std::string("#"), std::string("#1="), std::string("#1=IFCPOLYLINE("), std::string(";;#;"),
        std::string("#1=IFCARBITRARYPROFILEDEFWITHVOIDS(.AREA.,$,#1,(#1));"), plate(two_voids).substr(0, 1500)}) {
    EXPECT_EQ(with_joined_voids(damaged).text, damaged);
  }
}

}  // namespace
}  // namespace patchlight::ifc_voids_test
