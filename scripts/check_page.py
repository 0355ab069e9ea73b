#!/usr/bin/env python3
"""Opens pages of patchlight in a headless Chromium, clicks patches and compares the values that it shows with the .vtp.

usage: scripts/check_page.py TOOL FOLDER    writes pages, results and screenshots into FOLDER
A page must open without a message on its console; of five patches clicked the values are those of the .vtp of the same
run, and the place clicked lies on the patch. Names that are HTML stay text, the scene behind panes is visible, the
legend's range by day is of the inside, and no note stands there twice. A closed room in which all that can be seen has
one radiance shows no dark pixel and no gap, from inside, from outside and in sections, however its faces overlap.
Without Chromium the script prints a line and returns 0, unless CI is set.
"""
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from read_vtp import read_vtp

ROOT = pathlib.Path(__file__).resolve().parent.parent
BROWSER = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--hide-scrollbars", "--disable-extensions", "--enable-logging=stderr", "--virtual-time-budget=30000"]
LUMINOUS = (179 * 0.2126, 179 * 0.7152, 179 * 0.0722)  # lm/W times the weights of Rec. 709

# Clicks places of the canvas until five patches are found, and replaces the page by the values that it shows.
CLICKS = """<script>
const data = JSON.parse(document.getElementById("data").textContent);
setTimeout(() => {
  const canvas = document.getElementById("canvas"), found = {}, panes = [], hasPane = data.model.materials.includes("glass");
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const drawn = copy.getContext("2d", {willReadFrequently: true});
  if (canvas.clientWidth > 0) drawn.drawImage(canvas, 0, 0);
  const choose = (name) => {
    const select = document.getElementById("quantity");
    if (![...select.options].some((option) => option.value === name)) return;
    select.value = name;
    select.dispatchEvent(new Event("change"));
  };
  for (let k = 0; k < 400 && (hasPane || Object.keys(found).length < 5) && canvas.clientWidth > 0; ++k) {
    const box = canvas.getBoundingClientRect();
    const at = {clientX: box.left + box.width * (0.05 + 0.9 * ((k * 0.618034) % 1)), clientY: box.top + box.height * (0.05 + 0.9 * ((k * 0.754878) % 1)), bubbles: true};
    canvas.dispatchEvent(new MouseEvent("click", at));
    const told = {};
    for (const value of document.querySelectorAll("#values dd")) told[value.dataset.name] = value.dataset.value;
    if (told.patch !== undefined && Object.keys(found).length < 5) found[told.patch] = told;
    if (told.material === "glass")
      panes.push(Math.min(...drawn.getImageData((at.clientX - box.left) * copy.width / box.width, (at.clientY - box.top) * copy.height / box.height, 1, 1).data.slice(0, 3)));
  }
  choose("luminance");
  const facts = {state: document.documentElement.dataset.state, patches: Object.values(found), bold: document.querySelectorAll("b, blink").length, injected: window.injected === true,
    title: document.title, lost: document.getElementById("lost").textContent, headings: [...document.querySelectorAll("h2")].map((heading) => heading.textContent),
    unlabelled: [...document.querySelectorAll("input, select")].filter((control) => control.labels.length === 0).length, options: document.getElementById("quantity").options.length,
    ticks: document.getElementById("ticks").textContent, panes, extremes: document.getElementById("extremes").textContent, top: Number(document.getElementById("high").value),
    notes: [...document.querySelectorAll("#notes p")].map((note) => note.firstChild.textContent.replace(/^(note|remark|warning|error): \\w+: /, "").trim()),
    looks: data.model.looks.map((look) => look.name)};
  const pre = document.createElement("pre");
  pre.id = "check";
  pre.textContent = JSON.stringify(facts);
  document.body.replaceChildren(pre);
  document.head.replaceChildren();
}, 4000);
</script></body>"""


# A page whose background is white. Frames are drawn without the screen, which a browser without a window may not have.
WHITE = """<style>:root { --stage: #fff !important; }</style>
<script>window.requestAnimationFrame = (draw) => setTimeout(draw, 0);</script></head>"""

# Counts pixels of views of the model: those darker than any surface of it, and those as bright as the background.
PIXELS = """<script>
const counts = {};
const later = () => new Promise((done) => setTimeout(done, 500));
const count = async (view) => {
  await later();
  const canvas = document.getElementById("canvas"), copy = document.createElement("canvas");
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const drawn = copy.getContext("2d");
  drawn.drawImage(canvas, 0, 0);
  const {data} = drawn.getImageData(0, 0, copy.width, copy.height);
  counts[view] = {all: data.length / 4, black: 0, white: 0, least: 255};
  for (let k = 0; k < data.length; k += 4) {
    const brightest = Math.max(data[k], data[k + 1], data[k + 2]);
    counts[view].least = Math.min(counts[view].least, brightest);
    counts[view].black += brightest < 100;
    counts[view].white += Math.min(data[k], data[k + 1], data[k + 2]) > 240;
  }
};
const set = (id, value) => { document.getElementById(id).value = value; document.getElementById(id).dispatchEvent(new Event("input")); };
const look = async () => {
  if (document.documentElement.dataset.state !== "ready") return setTimeout(look, 200);
  await count("inside");
  for (const id of ["outside", "above"]) {
    document.getElementById(id).click();
    await count(id);
  }
  for (const axis of [0, 1, 2]) {
    document.getElementById("outside").click();
    set("cut-axis", axis);
    set("cut-at", 450);
    await count("section " + "xyz"[axis]);
  }
  const pre = document.createElement("pre");
  pre.id = "check";
  pre.textContent = JSON.stringify(counts);
  document.body.replaceChildren(pre);
  document.head.replaceChildren();
};
look();
</script></body>"""


def browse(browser, page, *options):
    """The output of the browser, with the messages of the page's console."""
    with tempfile.TemporaryDirectory(prefix="patchlight-browser-") as profile:
        done = subprocess.run([browser, *BROWSER, f"--user-data-dir={profile}", *options, page.as_uri()],
                              capture_output=True, text=True, timeout=300, check=False)
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def facts_of(browser, page, script=CLICKS, head="</head>"):
    """The facts that a script finds on the page."""
    clicked = page.with_suffix(".clicked.html")
    html = page.read_text(encoding="utf-8").replace("</head>", head).replace("</body>", script)
    clicked.write_text(html, encoding="utf-8")
    printed, messages = browse(browser, clicked, "--dump-dom")
    clicked.unlink()
    found = re.search(r'<pre id="check">(.*?)</pre>', printed, re.DOTALL)
    if not found:
        return None, messages
    text = found[1].replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
    return json.loads(text), messages


def distance_to_plane(place, corners):
    """Distance of a place from the plane of three corners, and whether it lies inside the polygon's bounds, grown."""
    a, b, c = corners[:3]
    u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, c, place))
    normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    return abs(sum(n * x for n, x in zip(normal, w))) / math.sqrt(sum(n * n for n in normal))


def faults_of_patch(told, points, corners, cells):
    """The values of a patch on the page that differ from the .vtp."""
    patch = int(told["patch"])
    outline = [points[k] for k in corners[patch]]
    place = [float(word) for word in told["place"].split()]
    extent = max(max(p[k] for p in points) - min(p[k] for p in points) for k in range(3))
    step = extent / 65535  # by which the page lowers faces under others
    if distance_to_plane(place, outline) > 2 * step:
        yield f"patch {patch}: the place clicked is {distance_to_plane(place, outline)} m off its plane"
    if any(not min(p[k] for p in outline) - 2 * step <= place[k] <= max(p[k] for p in outline) + 2 * step
           for k in range(3)):
        yield f"patch {patch}: the place clicked is not on it"
    expected = {"source_polygon": cells["source_polygon"][patch], "area": cells["area"][patch],
                "radiance": cells["radiance"][patch], "irradiance": cells["irradiance"][patch],
                "luminance": cells["luminance"][patch]}
    if len(cells["irradiance"][patch]) == 3:
        for name, array in (("illuminance", "irradiance"), ("direct_illuminance", "direct_irradiance"),
                            ("error_total", "error_total"), ("error_mesh", "error_mesh"),
                            ("error_form_factor", "error_form_factor"), ("error_solver", "error_solver")):
            if array in cells and name in told:
                expected[name] = [sum(w * x for w, x in zip(LUMINOUS, cells[array][patch]))]
    for name, values in expected.items():
        found = [float(word) for word in told[name].split()]
        # Both files have seven digits.
        if any(abs(a - b) > 1e-6 * abs(b) + 1e-12 for a, b in zip(found, values)) or len(found) != len(values):
            yield f"patch {patch}: {name} is {found} on the page, {list(values)} in the .vtp"


def faults_of_glass(facts, cells):
    """A room by day with one pane: the visible faces and the range of luminances."""
    if not facts["panes"] or min(facts["panes"]) < 64:
        yield f"the pane is not seen through: its pixels are {facts['panes']} of 255"
    if facts["looks"] != ["natural, exposed for the inside", "natural, exposed for the outside"]:
        yield f"there are the looks {facts['looks']}"
    # The outside is lit by the whole sky, and far brighter.
    brightest = max(luminance[0] for luminance in cells["luminance"])
    if " inside" not in facts["extremes"] or not facts["top"] < brightest / 2:
        yield f"the range ends at {facts['top']} where {brightest} is the most of all: {facts['extremes']}"


def check(browser, folder, name):
    """The faults of one page; prints its values."""
    page = folder / f"{name}.html"
    facts, messages = facts_of(browser, page)
    faults = [f"on the console: {message}" for message in messages]
    if facts is None:
        return faults + ["the page did not come to its end"]
    points, corners, cells = read_vtp(folder / f"{name}.vtp")
    for told in facts["patches"]:
        faults += faults_of_patch(told, points, corners, cells)
    if facts["state"] != "ready" or facts["lost"]:
        faults.append(f"the page is not ready: {facts['lost']}")
    if len(facts["patches"]) < 5:
        faults.append(f"found {len(facts['patches'])} patches by clicks; expected 5")
    if facts["bold"] or facts["injected"]:
        faults.append("a name became HTML")
    if len(set(facts["notes"])) < len(facts["notes"]):
        faults.append(f"a note stands there twice: {facts['notes']}")
    if name == "glass":
        faults += faults_of_glass(facts, cells)
    if facts["unlabelled"]:
        faults.append("a control has no label")
    print(f"page: {name}: {page.stat().st_size / 1e6:.2f} MB, patches "
          f"{', '.join(told['patch'] for told in facts['patches'])} as in the .vtp, {facts['options']} kinds of colours, "
          f"sections: {', '.join(facts['headings'])}")
    return faults


HOSTILE = {"</script><script>window.injected=true</script>": "0.5 0.5 0.5", '"><b>bold</b>': "0.4 0.2 0.1",
           "\U0001F4A1&lt;'\\u003c": "0.3 0.6 0.3"}


def write_hostile(folder):
    """A box whose material, object and file names are HTML."""
    names = list(HOSTILE)
    (folder / "hostile.mtl").write_text("".join(
        f"newmtl {name.replace(' ', '_')}\nKd {kd}\n" for name, kd in HOSTILE.items()) + "newmtl lamp\nKd 0 0 0\nKe 5 5 5\n",
        encoding="utf-8")
    faces = [(1, 2, 3, 4), (8, 7, 6, 5), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)]
    lines = ["mtllib hostile.mtl"] + [f"v {x} {y} {z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    for k, face in enumerate(faces):
        material = "lamp" if k == 1 else names[k % 3].replace(" ", "_")
        lines += [f"o <b>{k}</b>", f"usemtl {material}", "f " + " ".join(map(str, face))]
    (folder / "hostile.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_glass(folder):
    """A room whose floor, walls and ceiling are closed by one pane."""
    (folder / "glass.mtl").write_text("newmtl wall\nKd 0.5 0.5 0.5\nnewmtl glass\nKd 0 0 0\nd 0.2\n", encoding="utf-8")
    corners = [(x, y, z) for z in (0, 3) for x, y in ((0, 0), (5, 0), (5, 4), (0, 4))]
    faces = {"wall": [(4, 3, 2, 1), (5, 6, 7, 8), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8), (1, 2, 10, 9), (11, 12, 6, 5),
                      (1, 9, 11, 5), (10, 2, 6, 12)], "glass": [(9, 10, 12, 11)]}
    corners += [(1, 0, 1), (4, 0, 1), (1, 0, 2.5), (4, 0, 2.5)]
    lines = ["mtllib glass.mtl"] + [f"v {x} {y} {z}" for x, y, z in corners]
    for material, own in faces.items():
        lines += [f"usemtl {material}"] + ["f " + " ".join(map(str, face)) for face in own]
    (folder / "glass.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")


def turned(x, y, z):
    """A place of the room of write_seams(), along no axis."""
    x, y = 0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y
    return x, 0.96 * y - 0.28 * z, 0.28 * y + 0.96 * z


def write_seams(folder):
    """A closed room in which all visible surfaces have the same radiance.

    The parts of floor and ceiling have edges that do not meet those of the walls. A rug on the floor is smaller than
    each of its parts. Two equal panels coincide, a block stands on the floor, and an outer skin lies in the planes of
    the walls.
    """
    lit, other = [], []
    for x, y, far_x, far_y in ((0, 0, 2.3, 4), (2.3, 0, 5, 1.7), (2.3, 1.7, 5, 4)):
        lit.append([(x, y, 0), (far_x, y, 0), (far_x, far_y, 0), (x, far_y, 0)])
    for y, far_y in ((0, 0.9), (0.9, 3.1), (3.1, 4)):
        lit.append([(0, far_y, 3), (5, far_y, 3), (5, y, 3), (0, y, 3)])
    walls = [[(0, 0, 0), (0, 0, 3), (5, 0, 3), (5, 0, 0)], [(5, 0, 0), (5, 0, 3), (5, 4, 3), (5, 4, 0)],
             [(5, 4, 0), (5, 4, 3), (0, 4, 3), (0, 4, 0)], [(0, 4, 0), (0, 4, 3), (0, 0, 3), (0, 0, 0)]]
    lit += walls
    other += [wall[::-1] for wall in walls]
    rug = [(1.1, 1.2, 0), (2.9, 1.2, 0), (2.9, 3.3, 0), (1.1, 3.3, 0)]
    panel = [(0, 3.1, 0.6), (0, 3.1, 2.2), (0, 1.3, 2.2), (0, 1.3, 0.6)]
    lit += [rug, panel]
    other.append(panel)
    low, high = [(3.9, 2.9, 0), (4.6, 2.9, 0), (4.6, 3.7, 0), (3.9, 3.7, 0)], 1.1
    top = [(x, y, high) for x, y, _ in low]
    lit += [top, low[::-1]] + [[low[k - 1], low[k], top[k], top[k - 1]] for k in range(4)]
    (folder / "seams.mtl").write_text("newmtl lit\nKd 0.5 0.5 0.5\nKe 0.5 0.5 0.5\nnewmtl other\nKd 0.5 0.5 0.5\n",
                                      encoding="utf-8")
    lines, corner = ["mtllib seams.mtl"], 0
    for material, faces in (("lit", lit), ("other", other)):
        for face in faces:
            lines += [f"o face_{corner}", f"usemtl {material}"] + ["v %r %r %r" % turned(*place) for place in face]
            lines.append("f " + " ".join(str(corner + k + 1) for k in range(4)))
            corner += 4
    (folder / "seams.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    eye, target = turned(4.7, 0.3, 2.1), turned(0.9, 3.1, 0.8)
    (folder / "seams.toml").write_text(f"""up = "z"
[[model]]
file = "seams.obj"
[[camera]]
name = "inside"
eye = {list(eye)}
target = {list(target)}
field_of_view = 80
""", encoding="utf-8")


def faults_of_seams(browser, page):
    """A furnace has one color: no pixel of it is dark, and from inside none shows the background."""
    counts, messages = facts_of(browser, page, PIXELS, WHITE)
    yield from (f"on the console: {message}" for message in messages)
    if counts is None:
        yield "the page did not come to its end"
        return
    for view, count in counts.items():
        print(f"page: seams: {view}: {count['black']} of {count['all']} pixels are dark, the least bright {count['least']}")
        if count["black"] or count["white"] == count["all"]:
            yield f"{view}: {count['black']} pixels are dark, {count['white']} of {count['all']} show no face"
    if counts["inside"]["white"]:
        yield f"inside: {counts['inside']['white']} pixels show the background of a closed room"


def solve(tool, folder, name, *words):
    """Solves a scene with a page and a .vtp."""
    subprocess.run([tool, "solve", *map(str, words), "--quiet", "--html", folder / f"{name}.html", "-o",
                    folder / f"{name}.vtp"], check=True)


def main():
    tool, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if browser is None:
        if os.environ.get("CI"):
            sys.exit("error: page: there is no chromium; apt-get install --no-install-recommends chromium")
        print("page: there is no chromium; left out")
        return
    folder = folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    write_hostile(folder)
    rooms = folder / "rooms.toml"
    rooms.unlink(missing_ok=True)
    subprocess.run([tool, "init", ROOT / "meshes/two_rooms.obj", "-o", rooms], check=True, stdout=subprocess.DEVNULL)
    solve(tool, folder, "cornell_box", ROOT / "meshes/cornell_box.obj")
    solve(tool, folder, "two_rooms", ROOT / "meshes/two_rooms.obj", "--patches", 3000)
    solve(tool, folder, "accuracy", ROOT / "meshes/cornell_box.obj", "--sides", "front", "--accuracy", "1%")
    solve(tool, folder, "daylight", rooms, "--sky", "overcast:10000lx", "--patches", 3000)
    write_glass(folder)
    solve(tool, folder, "glass", folder / "glass.obj", "--up", "z", "--sky", "overcast:10000lx", "--patches", 400)
    solve(tool, folder, "hostile", folder / "hostile.obj", "--patches", 300)
    write_seams(folder)
    solve(tool, folder, "seams", folder / "seams.toml", "--sides", "both", "--patches", 1500)
    failed = False
    for fault in faults_of_seams(browser, folder / "seams.html"):
        failed = True
        print(f"error: page: seams: {fault}", file=sys.stderr)
    browse(browser, folder / "seams.html", f"--screenshot={folder / 'seams'}.png", "--window-size=1280,1800")
    for name in ("cornell_box", "two_rooms", "accuracy", "daylight", "glass", "hostile"):
        for fault in check(browser, folder, name):
            failed = True
            print(f"error: page: {name}: {fault}", file=sys.stderr)
        browse(browser, folder / f"{name}.html", f"--screenshot={folder / name}.png", "--window-size=1280,3600")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
