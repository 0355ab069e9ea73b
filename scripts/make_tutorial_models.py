#!/usr/bin/env python3
"""Writes the models of the tutorials: meshes/study.obj, meshes/office.obj, meshes/panel.ies and meshes/flat.ifc.

usage: scripts/make_tutorial_models.py [--check]    with --check: compares them with the files, writes nothing
"""
import argparse
import math
import sys

from make_meshes import MESHES, Material, Model, box, grey


def furniture(model, material, parts):
    """Named boxes: (name, low corner, high corner)."""
    for name, low, high in parts:
        model.group(name)
        box(model, material, low, high)


def table(name, x0, y0, x1, y1, height=0.74, leg=0.05, top=0.03):
    """The boxes of a table: its top and four legs."""
    legs = [(x, y) for x in (x0, x1 - leg) for y in (y0, y1 - leg)]
    return [(name, (x0, y0, height - top), (x1, y1, height))] + [
        (name, (x, y, 0), (x + leg, y + leg, height - top)) for x, y in legs
    ]


def study():
    """A windowless room with a table, a shelf and a bench. It has no lamp: the tutorial adds one."""
    model = Model(
        "study",
        ["A small study of 4 x 3 x 2.6 m, z up, metres: table, shelf and bench, no lamp."],
        [Material("floor", (0.42, 0.33, 0.24)), Material("walls", grey(0.7)), Material("ceiling", grey(0.85)),
         Material("wood", (0.55, 0.42, 0.28)), Material("cushion", (0.15, 0.3, 0.45))],
    )
    model.group("room")
    box(model, "walls", (0, 0, 0), (4, 3, 2.6), inward=True, materials={"-z": "floor", "+z": "ceiling"})
    furniture(model, "wood", table("table", 1.4, 1.0, 2.8, 1.7))
    furniture(model, "wood", [("shelf", (3.7, 0.4, z), (4, 2.2, z + 0.03)) for z in (0.9, 1.3, 1.7)])
    furniture(model, "cushion", [("bench", (0.4, 2.3, 0), (2.2, 2.9, 0.42))])
    return model


def office():
    """An office with four desks and screens, reflectances 0.7 / 0.5 / 0.2 as lighting engineers usually assume."""
    model = Model(
        "office",
        ["An office of 7.2 x 5.4 x 2.8 m, z up, metres: four desks with screens, no lamp, no window."],
        [Material("floor", grey(0.2)), Material("walls", grey(0.5)), Material("ceiling", grey(0.7)),
         Material("desk", (0.5, 0.45, 0.38)), Material("screen", grey(0.05))],
    )
    model.group("room")
    box(model, "walls", (0, 0, 0), (7.2, 5.4, 2.8), inward=True, materials={"-z": "floor", "+z": "ceiling"})
    for number, (x, y) in enumerate([(1.0, 1.0), (4.6, 1.0), (1.0, 3.6), (4.6, 3.6)], 1):
        furniture(model, "desk", table(f"desk_{number}", x, y, x + 1.6, y + 0.8, 0.74))
        furniture(model, "screen", [(f"screen_{number}", (x + 0.5, y + 0.6, 0.84), (x + 1.1, y + 0.63, 1.2))])
    return model


def panel_ies():
    """A square ceiling panel of 3,600 lm; its intensity falls as the cosine to the power 1.5, to 0 at 90 degrees."""
    lumens, power = 3600, 1.5
    angles = list(range(0, 91, 5))
    # Intensities are linear between the angles: their flux by zones, scaled to the stated lumens.
    steps = 18000
    flux = 0
    for k in range(steps):
        theta = (k + 0.5) / steps * math.pi / 2
        low = min(int(math.degrees(theta) // 5), len(angles) - 2)
        part = math.degrees(theta) / 5 - low
        at = [math.cos(math.radians(angles[low + i])) ** power if angles[low + i] < 90 else 0 for i in (0, 1)]
        flux += 2 * math.pi * math.sin(theta) * ((1 - part) * at[0] + part * at[1]) * (math.pi / 2 / steps)
    candelas = [lumens / flux * max(0, math.cos(math.radians(a))) ** power if a < 90 else 0 for a in angles]
    return "\n".join(
        ["IESNA:LM-63-2002", "[TEST] computed, no measurement", "[MANUFAC] none: written by scripts/make_tutorial_models.py",
         "[LUMCAT] panel", "[LUMINAIRE] square ceiling panel, 3600 lm, cosine to the power 1.5", "TILT=NONE",
         f"1 {lumens} 1 {len(angles)} 1 1 2 0.6 0.6 0", "1 1 30", " ".join(map(str, angles)), "0",
         " ".join(f"{c:.1f}" for c in candelas)]) + "\n"


class Ifc:
    """Entities of an IFC4 file in meters."""

    def __init__(self, name):
        self.lines, self.identifiers = [], 0
        self.origin = self.add(f"IFCAXIS2PLACEMENT3D({self.point(0, 0, 0)},$,$)")
        self.placement = self.add(f"IFCLOCALPLACEMENT($,{self.origin})")
        north = self.add("IFCDIRECTION((0.,1.))")
        self.context = self.add(f"IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,{self.origin},{north})")
        units = self.add(f"IFCUNITASSIGNMENT(({self.add('IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)')}))")
        project = self.add(f"IFCPROJECT('{self.identifier()}',$,'{name}',$,$,$,$,({self.context}),{units})")
        building = self.add(f"IFCBUILDING('{self.identifier()}',$,'{name}',$,$,{self.placement},$,$,.ELEMENT.,$,$,$)")
        self.storey = self.add(
            f"IFCBUILDINGSTOREY('{self.identifier()}',$,'Ground floor',$,$,{self.placement},$,$,.ELEMENT.,0.)")
        self.add(f"IFCRELAGGREGATES('{self.identifier()}',$,$,$,{project},({building}))")
        self.add(f"IFCRELAGGREGATES('{self.identifier()}',$,$,$,{building},({self.storey}))")
        self.up = self.add("IFCDIRECTION((0.,0.,1.))")
        self.styles = {}

    def add(self, entity):
        self.lines.append(f"#{len(self.lines) + 1}={entity};")
        return f"#{len(self.lines)}"

    def identifier(self):
        self.identifiers += 1
        return f"{self.identifiers:022d}"

    def point(self, *coordinates):
        return self.add("IFCCARTESIANPOINT((" + ",".join(f"{float(round(c, 4))}" for c in coordinates) + "))")

    def style(self, name, color, transparency=0.0):
        rgb = self.add("IFCCOLOURRGB($," + ",".join(str(float(c)) for c in color) + ")")
        rendering = self.add(f"IFCSURFACESTYLERENDERING({rgb},{float(transparency)},$,$,$,$,$,$,.FLAT.)")
        self.styles[name] = self.add(f"IFCSURFACESTYLE('{name}',.BOTH.,({rendering}))")

    def body(self, low, high, style=None):
        """A box as an extrusion."""
        size = [b - a for a, b in zip(low, high)]
        profile = self.add(f"IFCRECTANGLEPROFILEDEF(.AREA.,$,$,{float(round(size[0], 4))},{float(round(size[1], 4))})")
        middle = self.point((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2])
        place = self.add(f"IFCAXIS2PLACEMENT3D({middle},$,$)")
        solid = self.add(f"IFCEXTRUDEDAREASOLID({profile},{place},{self.up},{float(round(size[2], 4))})")
        if style:
            self.add(f"IFCSTYLEDITEM({solid},({self.styles[style]}),$)")
        return solid

    def shape(self, *bodies):
        drawn = self.add(f"IFCSHAPEREPRESENTATION({self.context},'Body','SweptSolid',({','.join(bodies)}))")
        return self.add(f"IFCPRODUCTDEFINITIONSHAPE($,$,({drawn}))")

    def element(self, kind, name, *bodies):
        tail = ",$,$,$,$,$,$" if kind in ("IFCWINDOW", "IFCDOOR") else ",$,$"
        shape = self.shape(*bodies)
        number = self.add(f"{kind}('{self.identifier()}',$,'{name}',$,$,{self.placement},{shape}{tail})")
        if kind != "IFCOPENINGELEMENT":
            self.add(f"IFCRELCONTAINEDINSPATIALSTRUCTURE('{self.identifier()}',$,$,$,({number}),{self.storey})")
        return number

    def cut(self, wall, low, high):
        opening = self.element("IFCOPENINGELEMENT", "opening", self.body(low, high))
        self.add(f"IFCRELVOIDSELEMENT('{self.identifier()}',$,$,$,{wall},{opening})")

    def space(self, number, name, low, high):
        shape = self.shape(self.body(low, high))
        space = self.add(f"IFCSPACE('{self.identifier()}',$,'{number}',$,$,{self.placement},{shape},'{name}',"
                         ".ELEMENT.,.INTERNAL.,$)")
        self.add(f"IFCRELAGGREGATES('{self.identifier()}',$,$,$,{self.storey},({space}))")

    def text(self):
        head = ["ISO-10303-21;", "HEADER;", "FILE_DESCRIPTION(('A small flat. Written by scripts/make_tutorial_models.py'),'2;1');",
                "FILE_NAME('flat.ifc','',(''),(''),'','','');", "FILE_SCHEMA(('IFC4'));", "ENDSEC;", "DATA;"]
        return "\n".join(head + self.lines + ["ENDSEC;", "END-ISO-10303-21;"]) + "\n"


def flat():
    """A flat of six rooms on one floor. y points north; outer walls are 0.3 m thick, inner walls 0.12 m."""
    height, inner, outer = 2.6, 0.12, 0.3
    x = [0.3, 3.8, 5.8, 9.7]  # left edge, kitchen | hall, hall | study and bathroom, right edge
    y = [0.3, 4.5, 6.3, 8.5]  # living room and bedroom, kitchen, hall and bathroom, study
    ifc = Ifc("flat")
    for name, color, transparency in [
        ("Plaster", (0.75, 0.75, 0.72), 0), ("Ceiling paint", (0.85, 0.85, 0.85), 0), ("Parquet", (0.4, 0.3, 0.2), 0),
        ("Glass", (0.05, 0.05, 0.05), 0.9), ("Door leaf", (0.7, 0.65, 0.55), 0),
        ("Fabric", (0.3, 0.35, 0.4), 0), ("Wood", (0.5, 0.38, 0.25), 0)]:
        ifc.style(name, color, transparency)

    ifc.element("IFCSLAB", "floor", ifc.body((0, 0, -0.2), (x[3] + outer, y[3] + outer, 0), "Parquet"))
    ifc.element("IFCSLAB", "ceiling", ifc.body((0, 0, height), (x[3] + outer, y[3] + outer, height + 0.2), "Ceiling paint"))

    def wall(name, low, high):
        return ifc.element("IFCWALL", name, ifc.body((*low, 0), (*high, height), "Plaster"))

    south = wall("south wall", (0, 0), (x[3] + outer, outer))
    north = wall("north wall", (0, y[3]), (x[3] + outer, y[3] + outer))
    wall("west wall", (0, outer), (outer, y[3]))
    east = wall("east wall", (x[3], outer), (x[3] + outer, y[3]))
    middle = wall("middle wall", (x[0], y[1]), (x[3], y[1] + inner))
    bedroom = wall("living room | bedroom", (x[2], y[0]), (x[2] + inner, y[1]))
    kitchen = wall("kitchen | hall", (x[1], y[1] + inner), (x[1] + inner, y[3]))
    hall = wall("hall | study", (x[2], y[1] + inner), (x[2] + inner, y[3]))
    wall("bathroom | study", (x[2] + inner, y[2]), (x[3], y[2] + inner))

    def window(name, of, low, high):
        """A pane in an opening; the wall runs along x or y."""
        ifc.cut(of, low, high)
        across = 1 if high[0] - low[0] > high[1] - low[1] else 0
        lo, hi = list(low), list(high)
        center = (low[across] + high[across]) / 2
        lo[across], hi[across] = center - 0.012, center + 0.012
        ifc.element("IFCWINDOW", name, ifc.body(lo, hi, "Glass"))

    window("living room, left", south, (0.9, 0, 0.85), (2.7, outer, 2.25))
    window("living room, right", south, (3.4, 0, 0.05), (5.2, outer, 2.25))
    window("bedroom", south, (6.9, 0, 0.85), (8.7, outer, 2.25))
    window("kitchen", north, (1.2, y[3], 1.0), (2.6, y[3] + outer, 2.25))
    window("bathroom", east, (x[3], 5.0, 1.5), (x[3] + outer, 5.8, 2.25))
    window("study", north, (6.9, y[3], 0.85), (8.7, y[3] + outer, 2.25))

    def door(name, of, x0, y0, along, closed=True, depth=inner):
        """0.9 m wide in a wall along x (0) or y (1) that begins at x0, y0."""
        low, high = [x0, y0, 0], [x0 + depth, y0 + depth, 2.1]
        high[along] = low[along] + 0.9
        ifc.cut(of, low, high)
        if closed:
            low[1 - along], high[1 - along] = low[1 - along] + 0.04, low[1 - along] + 0.08
            ifc.element("IFCDOOR", name, ifc.body(low, high, "Door leaf"))

    door("living room, open", middle, 4.3, y[1], 0, closed=False)
    door("bedroom", bedroom, x[2], 3.4, 1)
    door("kitchen", kitchen, x[1], 5.0, 1)
    door("bathroom", hall, x[2], 5.0, 1)
    door("study", hall, x[2], 6.9, 1)
    door("front door", north, 4.35, y[3], 0, depth=outer)

    for name, low, high, style in [
        ("sofa", (0.5, 3.2, 0.05), (2.7, 4.1, 0.45), "Fabric"), ("sofa, back", (0.5, 4.1, 0.05), (2.7, 4.3, 0.85), "Fabric"),
        ("coffee table", (1.1, 2.1, 0.38), (2.1, 2.7, 0.42), "Wood"), ("bed", (7.6, 1.6, 0.1), (9.6, 3.2, 0.5), "Fabric"),
        ("wardrobe", (7.4, 3.85, 0.05), (9.2, 4.45, 2.1), "Wood"), ("counter", (0.35, 4.7, 0.05), (0.95, 8.4, 0.9), "Wood"),
        ("desk", (8.8, 6.7, 0.7), (9.6, 8.3, 0.74), "Wood")]:
        ifc.element("IFCFURNITURE", name, ifc.body(low, high, style))

    for number, name, low, high in [
        ("1", "Living room", (x[0], y[0]), (x[2], y[1])), ("2", "Bedroom", (x[2] + inner, y[0]), (x[3], y[1])),
        ("3", "Kitchen", (x[0], y[1] + inner), (x[1], y[3])), ("4", "Hall", (x[1] + inner, y[1] + inner), (x[2], y[3])),
        ("5", "Bathroom", (x[2] + inner, y[1] + inner), (x[3], y[2])), ("6", "Study", (x[2] + inner, y[2] + inner), (x[3], y[3]))]:
        ifc.space(number, name, (*low, 0), (*high, height))
    return ifc.text()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare with the files, write nothing")
    check = parser.parse_args().check
    texts = {f"{model.name}.{kind}": text for model in (study(), office())
             for kind, text in (("obj", model.obj()), ("mtl", model.mtl()))}
    texts |= {"panel.ies": panel_ies(), "flat.ifc": flat()}
    differ = [name for name, text in texts.items() if not (MESHES / name).exists() or (MESHES / name).read_text() != text]
    for name in differ if check else texts:
        print("differs from the output of this script:" if check else "wrote", name)
        if not check:
            (MESHES / name).write_text(texts[name])
    return 1 if check and differ else 0


if __name__ == "__main__":
    sys.exit(main())
