# Completion of patchlight for bash. scripts/make_help.py writes this file.
_patchlight() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
  local words=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="check init solve render annual plan crosscheck relight form-factors compare-solvers convergence selftest help --help --version"
  else
    case "$command,$before" in
      check,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      check,--unit) words="m cm mm in ft" ;;
      check,--up) words="y z" ;;
      check,--sides) words="auto front both" ;;
      init,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      init,--unit) words="m cm mm in ft" ;;
      init,--up) words="y z" ;;
      solve,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      solve,--unit) words="m cm mm in ft" ;;
      solve,--up) words="y z" ;;
      solve,--picture-quality) words="draft final" ;;
      solve,--map) words="illuminance daylight-factor" ;;
      solve,--sides) words="auto front both" ;;
      solve,--method) words="auto pairs rays on-demand" ;;
      solve,--solver) words="jacobi gauss-seidel sor symmetric-gauss-seidel chebyshev progressive overshooting cg deflated-cg gmres bicgstab" ;;
      solve,--estimator) words="auto area point-polygon hemisphere contour" ;;
      render,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      render,--unit) words="m cm mm in ft" ;;
      render,--up) words="y z" ;;
      render,--picture-quality) words="draft final" ;;
      annual,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      annual,--unit) words="m cm mm in ft" ;;
      annual,--up) words="y z" ;;
      annual,--sides) words="auto front both" ;;
      annual,--method) words="auto pairs rays on-demand" ;;
      annual,--sky-division) words="1 2 4" ;;
      annual,--estimator) words="auto area point-polygon hemisphere contour" ;;
      plan,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      plan,--unit) words="m cm mm in ft" ;;
      plan,--up) words="y z" ;;
      plan,--sides) words="auto front both" ;;
      plan,--method) words="auto pairs rays on-demand" ;;
      plan,--estimator) words="auto area point-polygon hemisphere contour" ;;
      crosscheck,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      crosscheck,--unit) words="m cm mm in ft" ;;
      crosscheck,--up) words="y z" ;;
      crosscheck,--sides) words="auto front both" ;;
      crosscheck,--method) words="auto pairs rays on-demand" ;;
      crosscheck,--estimator) words="auto area point-polygon hemisphere contour" ;;
      relight,--up) words="y z" ;;
      relight,--picture-quality) words="draft final" ;;
      relight,--map) words="illuminance daylight-factor" ;;
      relight,--solver) words="jacobi gauss-seidel sor symmetric-gauss-seidel chebyshev progressive overshooting cg deflated-cg gmres bicgstab" ;;
      form-factors,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      form-factors,--unit) words="m cm mm in ft" ;;
      form-factors,--up) words="y z" ;;
      form-factors,--matrix) words="npy mtx" ;;
      form-factors,--by) words="material object" ;;
      form-factors,--sides) words="auto front both" ;;
      form-factors,--method) words="pairs rays" ;;
      form-factors,--estimator) words="auto area point-polygon hemisphere contour" ;;
      form-factors,--without) words="hidden free far" ;;
      compare-solvers,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      compare-solvers,--unit) words="m cm mm in ft" ;;
      compare-solvers,--up) words="y z" ;;
      compare-solvers,--sides) words="auto front both" ;;
      compare-solvers,--estimator) words="auto area point-polygon hemisphere contour" ;;
      convergence,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      convergence,--unit) words="m cm mm in ft" ;;
      convergence,--up) words="y z" ;;
      convergence,--sides) words="auto front both" ;;
      convergence,--estimator) words="auto area point-polygon hemisphere contour" ;;
    esac
    if [ -z "$words" ] && [[ $current == -* ]]; then
      case $command in
        check) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --sky --sun --ground --weather --json --all --problems --picture --camera --projection --view --size --sides -h --help --bands --color-error --no-merge --confine --ambient-occlusion" ;;
        init) words="--format --unit --up -o --output -h --help --confine" ;;
        solve) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --sky --sun --ground --weather -o --output --html --json --lightmap --texel --picture --camera --projection --view --size --exposure --false-color --picture-quality --points --points-output --map --map-range --patches --max-edge --sides --accuracy --time-limit --focus --no-refine --error-bars --no-error-bars --method --rays --form-factors --checkpoint --enable --disable --threads --memory --discard -q --quiet -v --verbose -h --help --bands --color-error --no-merge --confine --series --picture-error --picture-samples --picture-error-map --ambient-occlusion --no-contact-lines --graded-edges --no-closure --solver --relaxation --tolerance --max-iterations --max-rows --samples --estimator --seed" ;;
        render) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --solution -o --output --html --lightmap --texel --difference --observers --sky --sun --ground --weather --camera --projection --view --size --exposure --false-color --picture-quality --threads -q --quiet -h --help --bands --color-error --no-merge --confine --picture-error --picture-samples --picture-error-map" ;;
        annual) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --ground --weather --hours -o --output --points --patches --max-edge --sides --accuracy --time-limit --focus --no-refine --error-bars --no-error-bars --method --rays --enable --disable --threads --memory -q --quiet -h --help --bands --color-error --no-merge --confine --sky-division --no-contact-lines --samples --estimator --seed" ;;
        plan) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --sky --sun --ground --weather --json --patches --max-edge --sides --accuracy --time-limit --focus --no-refine --error-bars --no-error-bars --method --rays --enable --disable --threads --memory -h --help --bands --color-error --no-merge --confine --no-contact-lines --graded-edges --no-closure --samples --estimator --seed" ;;
        crosscheck) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --sky --sun --ground --weather --json --patches --max-edge --sides --accuracy --time-limit --focus --no-refine --method --rays --enable --disable --paths --sample-patches --margin --threads --memory -q --quiet -h --help --bands --color-error --no-merge --confine --no-contact-lines --graded-edges --no-closure --samples --estimator --seed" ;;
        relight) words="--up --set --sky --sun --ground --weather -o --output --html --json --lightmap --texel --picture --camera --projection --view --size --exposure --false-color --picture-quality --points --points-output --map --map-range --enable --disable --threads --memory --discard -q --quiet -v --verbose -h --help --series --picture-error --picture-samples --picture-error-map --ambient-occlusion --no-closure --solver --relaxation --tolerance --max-iterations --max-rows" ;;
        form-factors) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --sky --sun --ground --weather -o --output --matrix --by --patches --max-edge --sides --method --rays --threads --memory -q --quiet -h --help --bands --color-error --no-merge --confine --no-contact-lines --graded-edges --no-closure --samples --estimator --without --seed --enable --disable" ;;
        compare-solvers) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --sky --sun --ground --weather -o --output --html --solvers --no-series --patches --max-edge --sides --tolerance --max-iterations --enable --disable --threads --memory -q --quiet -h --help --bands --color-error --no-merge --confine --no-contact-lines --graded-edges --no-closure --relaxation --samples --estimator --seed" ;;
        convergence) words="--format --unit --up --set --only --exclude --simplify --maintenance-factor --sky --sun --ground --weather -o --output --html --sizes --no-adaptive --no-estimators --patches --max-edge --sides --tolerance --enable --disable --threads --memory -q --quiet -h --help --bands --color-error --no-merge --confine --no-contact-lines --samples --estimator --seed" ;;
        selftest) words="--json --threads -h --help" ;;
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
