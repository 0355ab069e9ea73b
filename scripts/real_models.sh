#!/usr/bin/env bash
# Checks and solves the real models that docs/models.md describes, and makes its pictures.
# usage: scripts/real_models.sh MODELS OUT [NAME...]    MODELS: folder of the models; names: veach-ajar radiator duplex
# kitchen openroom duplex-daylight ies. PATCHLIGHT_TOOL is the tool, build/src/patchlight if not set.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

models=${1:?usage: scripts/real_models.sh MODELS OUT [NAME...]}
out=${2:?usage: scripts/real_models.sh MODELS OUT [NAME...]}
shift 2
names=("$@")
[ ${#names[@]} -gt 0 ] || names=(veach-ajar radiator duplex kitchen openroom duplex-daylight ies)
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
arriving = 179 * json.load(open(sys.argv[1]))["energy_balance"]["arriving_W"][0]  # lm/W, docs/lights.md
stated = 5297.4
error = arriving / stated - 1
print(f"real models: ies: {arriving:.1f} lm arrive on the walls, {stated} lm expected: {100 * error:+.3f} %")
sys.exit(abs(error) > 0.01)
END
}

for name in "${names[@]}"; do
  echo "real models: $name"
  case $name in
    veach-ajar)
      python3 scripts/mitsuba_to_obj.py "$models/veach-ajar/scene.xml" "$out/veach-ajar.obj" 2>/dev/null
      files=("$out/veach-ajar.obj")
      options=(--patches 20000 --camera 4.054,1.616,-2.3065 3.064,1.584,-2.4437 50)
      ;;
    radiator)
      # A room of 3 x 2.5 x 2.6 m around the radiator, which is modelled in centimetres, and a lamp under its ceiling.
      printf '%s\n' 'newmtl wall' 'Kd 0.7 0.68 0.62' 'newmtl lamp' 'Kd 0.5 0.5 0.5' 'Ke 10 10 10' >"$out/radiator_room.mtl"
      printf '%s\n' 'mtllib radiator_room.mtl' 'v -150 0 -12.5' 'v 150 0 -12.5' 'v 150 0 250' 'v -150 0 250' \
        'v -150 250 -12.5' 'v 150 250 -12.5' 'v 150 250 250' 'v -150 250 250' 'v -30 249 100' 'v 30 249 100' \
        'v 30 249 160' 'v -30 249 160' 'usemtl wall' 'f 1 4 3 2' 'f 5 6 7 8' 'f 1 2 6 5' 'f 2 3 7 6' 'f 3 4 8 7' \
        'f 4 1 5 8' 'usemtl lamp' 'f 9 10 11 12' >"$out/radiator_room.obj"
      files=("$out/radiator_room.obj" "$models/furniture-cc0/blendswap-cc-0/radiator/radiator.obj")
      options=(--unit cm --patches 15000 --camera 60,140,240 -10,40,0 55)
      ;;
    duplex)
      files=("$models/duplex-ifc/Duplex_A.ifc")
      options=(--set Sash.radiance=100 --patches 25000 --tolerance 1e-3 --camera 3,-4.7,1.6 7.5,-1.5,0.9 75)
      ;;
    kitchen)
      python3 scripts/mitsuba_to_obj.py "$models/kitchen/kitchen.xml" "$out/kitchen.obj" 2>/dev/null
      files=("$out/kitchen.obj")
      options=()
      ;;
    openroom)
      # The materials that its files name are those of their origin: glass_60 lets 60 % through.
      printf 'void plastic %s 0 0 5 %s %s %s 0 0\n' white_paint_70 .7 .7 .7 white_paint_50 .5 .5 .5 carpet_20 .2 .2 .2 \
        >"$out/openroom.mat"
      printf 'void glass glass_60 0 0 3 .654 .654 .654\n' >>"$out/openroom.mat"
      python3 scripts/radiance_to_obj.py "$out/openroom.obj" "$out/openroom.mat" "$models"/frads-office/openroom/*.rad
      cat >"$out/openroom.toml" <<'END'
up = "z"

[[model]]
file = "openroom.obj"              # in metres

[[material]]
name = "glass_60"
transmittance = 0.6

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
      options=(--patches 8000 --points-output "$out/openroom.csv")
      ;;
    duplex-daylight)
      # Panes and the sashes that they lie in are solids: two faces each.
      cat >"$out/duplex-daylight.toml" <<END
up = "z"

[[model]]
file = "$models/duplex-ifc/Duplex_A.ifc"

[[material]]
name = "Glass*"
transmittance = 0.94
reflectance = 0.05

[[material]]
name = "Sash"
transmittance = 1
reflectance = 0

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
      options=(--patches 8000 --on-demand --solver progressive --max-rows 2%
        --points-output "$out/duplex-daylight.csv")
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
  "$tool" check "${files[@]}" $([ "$name" = radiator ] && echo --unit cm) >"$out/$name.check.txt" 2>&1 || [ $? -eq 2 ]
  [ ${#options[@]} -gt 0 ] || continue
  # A first picture (--max-rows) ends with exit code 3.
  "$tool" solve "${files[@]}" --storage tiles "${options[@]}" -o "$out/$name.vtp" --picture "$out/$name.png" --report "$out/$name.json" \
    --verbose >"$out/$name.solve.txt" 2>&1 || { [ $? -eq 3 ] && [ "$name" = duplex-daylight ]; }
  case $name in
    openroom) python3 scripts/sensor_map.py "$out/openroom.csv" "$out/openroom.svg" ;;
    duplex-daylight)
      python3 scripts/sensor_map.py "$out/duplex-daylight.csv" "$out/duplex-daylight.svg" --column E_v_lx
      ;;
    ies) check_flux "$out/ies.json" ;;
  esac
done
