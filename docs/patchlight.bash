# Completion of patchlight for bash. scripts/make_help.py writes this file.
_patchlight() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
  local words=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="solve check new plan form-factors relight render compare study verify validate --help --version"
  else
    case "$command,$before" in
      solve,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      solve,--unit) words="m cm mm in ft" ;;
      solve,--up) words="y z" ;;
      solve,--sides) words="auto front both" ;;
      solve,--quality) words="draft final" ;;
      solve,--map) words="illuminance daylight-factor" ;;
      solve,--storage) words="auto tiles rays on-demand" ;;
      solve,--solver) words="jacobi gauss-seidel sor symmetric-gauss-seidel chebyshev progressive overshooting cg deflated-cg gmres bicgstab" ;;
      solve,--estimator) words="auto area point-polygon hemisphere contour" ;;
      check,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      check,--unit) words="m cm mm in ft" ;;
      check,--up) words="y z" ;;
      check,--sides) words="auto front both" ;;
      new,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      new,--unit) words="m cm mm in ft" ;;
      new,--up) words="y z" ;;
      plan,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      plan,--unit) words="m cm mm in ft" ;;
      plan,--up) words="y z" ;;
      plan,--sides) words="auto front both" ;;
      plan,--storage) words="auto tiles rays on-demand" ;;
      plan,--estimator) words="auto area point-polygon hemisphere contour" ;;
      form-factors,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      form-factors,--unit) words="m cm mm in ft" ;;
      form-factors,--up) words="y z" ;;
      form-factors,--sides) words="auto front both" ;;
      form-factors,--matrix) words="npy mtx" ;;
      form-factors,--by) words="material object" ;;
      form-factors,--without) words="hidden free far" ;;
      form-factors,--storage) words="tiles rays" ;;
      form-factors,--estimator) words="auto area point-polygon hemisphere contour" ;;
      relight,--up) words="y z" ;;
      relight,--quality) words="draft final" ;;
      relight,--map) words="illuminance daylight-factor" ;;
      relight,--solver) words="jacobi gauss-seidel sor symmetric-gauss-seidel chebyshev progressive overshooting cg deflated-cg gmres bicgstab" ;;
      render,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      render,--unit) words="m cm mm in ft" ;;
      render,--up) words="y z" ;;
      render,--quality) words="draft final" ;;
      compare,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      compare,--unit) words="m cm mm in ft" ;;
      compare,--up) words="y z" ;;
      compare,--sides) words="auto front both" ;;
      compare,--estimator) words="auto area point-polygon hemisphere contour" ;;
      study,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      study,--unit) words="m cm mm in ft" ;;
      study,--up) words="y z" ;;
      study,--sides) words="auto front both" ;;
      study,--estimator) words="auto area point-polygon hemisphere contour" ;;
      verify,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      verify,--unit) words="m cm mm in ft" ;;
      verify,--up) words="y z" ;;
      verify,--sides) words="auto front both" ;;
      verify,--estimator) words="auto area point-polygon hemisphere contour" ;;
      verify,--storage) words="auto tiles rays on-demand" ;;
    esac
    if [ -z "$words" ] && [[ $current == -* ]]; then
      case $command in
        solve) words="-h --help --format --unit --up --confine --set --only --leave-out --detail --maintenance-factor --bands --color-error --keep-faces --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges -o --output --ambient-occlusion --html --series --report --picture --false-color --camera --projection --view --size --quality --picture-error --picture-samples --picture-error-map --lightmap --texel --points --points-output --map --map-range --accuracy --time --interest --keep-mesh --error-bars --no-error-bars --form-factors --on-demand --storage --rays --checkpoint --no-closure --relaxation --solver --tolerance --max-iterations --max-rows --samples --estimator --seed --force --skip --threads --memory --discard -q --quiet -v --verbose" ;;
        check) words="-h --help --format --unit --up --confine --set --only --leave-out --detail --maintenance-factor --bands --color-error --keep-faces --sky --sun --ground --weather --sides --all --json --vtk --picture --camera --projection --view --size --ambient-occlusion" ;;
        new) words="-h --help --format --unit --up --confine -o --output" ;;
        plan) words="-h --help --format --unit --up --confine --set --only --leave-out --detail --maintenance-factor --bands --color-error --keep-faces --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges --json --accuracy --time --interest --keep-mesh --error-bars --no-error-bars --on-demand --storage --rays --samples --estimator --seed --force --skip --threads --memory" ;;
        form-factors) words="-h --help --format --unit --up --confine --set --only --leave-out --detail --maintenance-factor --bands --color-error --keep-faces --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges --force --skip -o --output --matrix --by --without --raw --storage --rays --samples --estimator --seed --threads --memory -q --quiet" ;;
        relight) words="-h --help --set --up --sky --sun --ground --weather --force --skip -o --output --ambient-occlusion --html --series --report --picture --false-color --camera --projection --view --size --quality --picture-error --picture-samples --picture-error-map --lightmap --texel --points --points-output --map --map-range --no-closure --relaxation --solver --tolerance --max-iterations --max-rows --threads --memory --discard -q --quiet -v --verbose" ;;
        render) words="-h --help --format --unit --up --confine --set --only --leave-out --detail --maintenance-factor --bands --color-error --keep-faces --sky --sun --ground --weather --solution -o --output --false-color --camera --projection --view --size --quality --picture-error --picture-samples --picture-error-map --difference --observers --lightmap --texel --html --threads -q --quiet" ;;
        compare) words="-h --help --format --unit --up --confine --set --only --leave-out --detail --maintenance-factor --bands --color-error --keep-faces --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges --force --skip -o --output --html --solvers --tolerance --max-iterations --no-series --no-closure --relaxation --samples --estimator --seed --threads --memory -q --quiet" ;;
        study) words="-h --help --format --unit --up --confine --set --only --leave-out --detail --maintenance-factor --bands --color-error --keep-faces --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --force --skip -o --output --html --sizes --tolerance --no-adaptive --no-estimators --samples --estimator --seed --threads --memory -q --quiet" ;;
        verify) words="-h --help --format --unit --up --confine --set --only --leave-out --detail --maintenance-factor --bands --color-error --keep-faces --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges --force --skip --paths --checked --bar --json --accuracy --time --interest --keep-mesh --samples --estimator --seed --on-demand --storage --rays --threads --memory -q --quiet" ;;
        validate) words="-h --help --json --threads" ;;
      esac
    fi
  fi
  if [ -n "$words" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}
complete -o filenames -F _patchlight patchlight
