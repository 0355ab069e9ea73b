#!/usr/bin/env bash
# Checks and solves the real models that docs/models.md describes, and makes its pictures.
# usage: scripts/real_models.sh MODELS OUT [NAME...]    MODELS: folder of the models; names: veach-ajar radiator duplex
# kitchen furniture openroom office house duplex-daylight honeybee ies. Writes OUT/NAME.* and the table OUT/costs.md. PATCHLIGHT_TOOL is the
# tool, build/src/patchlight if not set.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

models=${1:?usage: scripts/real_models.sh MODELS OUT [NAME...]}
out=${2:?usage: scripts/real_models.sh MODELS OUT [NAME...]}
shift 2
names=("$@")
[ ${#names[@]} -gt 0 ] || names=(veach-ajar radiator duplex kitchen furniture openroom office house duplex-daylight honeybee ies)
tool=${PATCHLIGHT_TOOL:-build/src/patchlight}
if [ ! -d "$models" ]; then
  echo "real models: $models is not there; left out"
  exit 0
fi
models=$(realpath "$models")
mkdir -p "$out"

# Fails when the light that arrives in a black room is more than 1 % off the luminaire's flux: an independent zonal sum
# of the file, 91.3 % of its two lamps of 2,900 lm.
check_flux() {
  python3 - "$1" <<'END'
import json, sys
arriving = 179 * json.load(open(sys.argv[1]))["energy_balance"]["arriving_W"][0]  # lm/W, docs/concepts/units-and-photometry.md
stated = 5297.4
error = arriving / stated - 1
print(f"real models: ies: {arriving:.1f} lm arrive on the walls, {stated} lm expected: {100 * error:+.3f} %")
sys.exit(abs(error) > 0.01)
END
}

# A row of the table: patches, storage, processor seconds, largest memory, stated error.
cost_row() {
  python3 - "$1" "$2" <<'END'
import json, math, sys
name, report = sys.argv[1], json.load(open(sys.argv[2]))
# The solver's error is null where no bound on it is known.
seconds = sum(cost["cpu_seconds"] for cost in report["costs"])
error = report["relative_error"]
total = f"{100 * math.hypot(error['mesh'], error['form_factor']):.2g} % (mesh {100 * error['mesh']:.2g}, form factors {100 * error['form_factor']:.2g})" if error else "not asked for"
print(f"| {name} | {report['input']['polygons']} | {report['mesh']['patches']} | {report['plan']['storage']} | {seconds:.0f} | "
      f"{report['memory_peak_bytes'] / 1e9:.2f} | {total} |")
END
}

# A room as a model of its own, and pieces of furniture in it.
furnished_room() {
  printf '%s\n' 'newmtl wall' 'Kd 0.75 0.73 0.68' 'newmtl floor' 'Kd 0.45 0.32 0.22' 'newmtl lamp' 'Kd 0.5 0.5 0.5' \
    'Ke 12 11 10' >"$out/furniture_room.mtl"
  printf '%s\n' 'mtllib furniture_room.mtl' 'v 0 0 0' 'v 5 0 0' 'v 5 0 4' 'v 0 0 4' 'v 0 2.6 0' 'v 5 2.6 0' 'v 5 2.6 4' \
    'v 0 2.6 4' 'v 2 2.59 1.5' 'v 3 2.59 1.5' 'v 3 2.59 2.5' 'v 2 2.59 2.5' 'usemtl floor' 'f 1 4 3 2' 'usemtl wall' \
    'f 5 6 7 8' 'f 1 2 6 5' 'f 2 3 7 6' 'f 3 4 8 7' 'f 4 1 5 8' 'usemtl lamp' 'f 9 10 11 12' >"$out/furniture_room.obj"
  printf 'up = "y"\n\n[[model]]\nfile = "furniture_room.obj"\n'
  # Name, place of its origin, degrees about the vertical.
  while read -r piece x y z turn; do
    printf '\n[[model]]\nfile = "%s"\nunit = "cm"\nrotate = {axis = "y", degrees = %s}\ntranslate = [%s, %s, %s]\n' \
      "$models/furniture-cc0/blendswap-cc-0/$piece/$piece.obj" "$turn" "$x" "$y" "$z"
  done <<'END'
L_shaped_sofa 1.3 0.0 0.9 0
televisionCabinet 4.6 0.09 2.0 -90
highCabinet 3.6 0.0 0.35 0
oakChair 2.8 0.02 2.9 150
oakChair 1.6 0.02 3.1 200
radiator 0.15 0.0 2.6 90
END
}

printf '| model | polygons | patches | storage | CPU s | GB | stated error |\n|---|---|---|---|---|---|---|\n' >"$out/costs.md"
for name in "${names[@]}"; do
  echo "real models: $name"
  unit=()
  case $name in
    veach-ajar)
      files=("$models/veach-ajar/scene.xml")
      options=(--patches 60000 --camera 4.054,1.616,-2.3065 3.064,1.584,-2.4437 50)
      ;;
    radiator)
      # A room of 3 x 2.5 x 2.6 m around the radiator, which is modelled in centimetres, and a lamp under its ceiling.
      printf '%s\n' 'newmtl wall' 'Kd 0.7 0.68 0.62' 'newmtl lamp' 'Kd 0.5 0.5 0.5' 'Ke 10 10 10' >"$out/radiator_room.mtl"
      printf '%s\n' 'mtllib radiator_room.mtl' 'v -150 0 -12.5' 'v 150 0 -12.5' 'v 150 0 250' 'v -150 0 250' \
        'v -150 250 -12.5' 'v 150 250 -12.5' 'v 150 250 250' 'v -150 250 250' 'v -30 249 100' 'v 30 249 100' \
        'v 30 249 160' 'v -30 249 160' 'usemtl wall' 'f 1 4 3 2' 'f 5 6 7 8' 'f 1 2 6 5' 'f 2 3 7 6' 'f 3 4 8 7' \
        'f 4 1 5 8' 'usemtl lamp' 'f 9 10 11 12' >"$out/radiator_room.obj"
      files=("$out/radiator_room.obj" "$models/furniture-cc0/blendswap-cc-0/radiator/radiator.obj")
      unit=(--unit cm)
      options=(--method rays --accuracy 2% --camera 60,140,240 -10,40,0 55)
      ;;
    duplex)
      rm -f "$out/duplex.toml"
      "$tool" init "$models/duplex-ifc/Duplex_A.ifc" -o "$out/duplex.toml" >/dev/null
      files=("$out/duplex.toml")
      options=(--view "A102 Living Room" --points-output "$out/duplex.csv")
      ;;
    honeybee)
      files=("$models/honeybee-rooms/model_radiance_grid_views.hbjson")
      options=(--sky overcast:10000lx --patches 6000 --points-output "$out/honeybee.csv" --points-output "$out/honeybee.svg" --map daylight-factor)
      ;;
    kitchen)
      # Nothing in it emits: three spheres in the middle of the room.
      cat >"$out/kitchen.toml" <<END
[[model]]
file = "$models/kitchen/kitchen.xml"

[[luminaire]]
name = "bulbs"
kind = "sphere"
positions = [[0.3, 2.4, 0], [0.3, 2.4, 2], [0.3, 2.4, 4]]
lumens = 1500
radius = 0.06

[[camera]]
name = "from the table"
eye = [1.211, 1.805, 3.852]
target = [0.773, 1.763, 2.954]
field_of_view = 60
END
      files=("$out/kitchen.toml")
      options=(--patches 60000)
      ;;
    furniture)
      # Six pieces, modelled in centimetres, in a room of 5 x 4 x 2.6 m with a lamp under its ceiling.
      furnished_room >"$out/furniture.toml"
      files=("$out/furniture.toml")
      options=(--patches 200000 --camera 4.7,1.9,3.7 1.2,0.6,0.6 75)
      ;;
    openroom)
      # The materials that its files name are those of their origin: glass_60 lets 60 % through.
      printf 'void plastic %s 0 0 5 %s %s %s 0 0\n' white_paint_70 .7 .7 .7 white_paint_50 .5 .5 .5 carpet_20 .2 .2 .2 \
        >"$out/openroom.mat"
      printf 'void glass glass_60 0 0 3 .654 .654 .654\n' >>"$out/openroom.mat"
      printf '[[model]]\nfile = "%s"\n\n' "$out/openroom.mat" "$models"/frads-office/openroom/*.rad >"$out/openroom.toml"
      cat >>"$out/openroom.toml" <<'END'
[sky]
kind = "overcast"
illuminance = 10000

[ground]
reflectance = 0.2

[[sensors]]
name = "desks"
corner = [0, 0.1, 0.75]
edges = [[12, 0, 0], [0, 13.9, 0]]
spacing = 0.5

[[camera]]
name = "windows"
eye = [9.5, 13.5, 1.7]
target = [4.5, 0, 1.3]
field_of_view = 60
END
      files=("$out/openroom.toml")
      options=(--patches 8000 --points-output "$out/openroom.csv" --points-output "$out/openroom.svg" --map daylight-factor)
      ;;
    office)
      # Its files are in feet.
      files=("$models/frads-office/Objects/materials.mat" "$models"/frads-office/Objects/*.rad)
      unit=(--unit ft)
      options=(--sky overcast:10000lx --patches 20000 --camera 38,44,7.5 12,3,3 75)
      ;;
    house)
      files=("$models/gbxml-urban-house/Urban_House_MEP.xml")
      options=(--sky overcast:10000lx --patches 15000 --camera -4.2,3.3,5.3 1.6,7.5,4.9 75)
      ;;
    duplex-daylight)
      cat >"$out/duplex-daylight.toml" <<END
up = "z"

[[model]]
file = "$models/duplex-ifc/Duplex_A.ifc"

[weather]
file = "$models/weather-ies/USA_CA_Oakland.Intl.AP.724930_TMY3.epw"
month = 12
day = 21
hour = 11

[[sensors]]
name = "living room floor"
corner = [0.4, -17.4, 0.03]
edges = [[6.4, 0, 0], [0, 5.6, 0]]
spacing = 0.2

[[camera]]
name = "living room"
eye = [5.8, -13.1, 1.6]
target = [1.3, -16.3, 0.6]
field_of_view = 75
END
      files=("$out/duplex-daylight.toml")
      options=(--patches 20000 --points-output "$out/duplex-daylight.csv" --points-output "$out/duplex-daylight.svg")
      ;;
    ies)
      cat >"$out/ies.toml" <<END
[[model]]
file = "$PWD/meshes/furnace_cube.obj"
scale = 4

[[material]]
name = "*"
reflectance = 0
exitance = 0

[[luminaire]]
kind = "ies"
file = "$models/radiance-cornell/examp1.ies"
position = [2, 2, 2]
END
      files=("$out/ies.toml")
      options=(--patches 4000)
      ;;
  esac
  # A model without a lamp is reported, and ends with exit code 2.
  "$tool" check "${files[@]}" "${unit[@]}" >"$out/$name.check.txt" 2>&1 || [ $? -eq 2 ]
  [ ${#options[@]} -gt 0 ] || continue
  # An accuracy that was not reached ends with exit code 3.
  "$tool" solve "${files[@]}" "${unit[@]}" "${options[@]}" -o "$out/$name.vtp" --picture "$out/$name.png" --json "$out/$name.json" \
    --verbose >"$out/$name.solve.txt" 2>&1 || [ $? -eq 3 ]
  cost_row "$name" "$out/$name.json" | tee -a "$out/costs.md"
  case $name in
    ies) check_flux "$out/ies.json" ;;
  esac
done
