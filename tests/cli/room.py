"""The model that the tests of the command-line tool share with the scripts that exercise it."""

# A closed room of 2 x 2 x 2 m whose faces look inward. A lamp of 0.5 x 0.5 m hangs below the ceiling and faces down,
# and a plate is in the middle.
ROOM = """mtllib room.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v -1 -1 2
v 1 -1 2
v 1 1 2
v -1 1 2
v -0.25 -0.25 1.9
v 0.25 -0.25 1.9
v 0.25 0.25 1.9
v -0.25 0.25 1.9
v -0.5 -0.5 1
v 0.5 -0.5 1
v 0.5 0.5 1
v -0.5 0.5 1
usemtl white
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
f 13 14 15 16
usemtl lamp
f 9 12 11 10
"""

MATERIALS = """newmtl white
Kd 0.7 0.6 0.5
newmtl lamp
Kd 0 0 0
Ke 10 9 8
"""
