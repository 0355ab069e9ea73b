# Completion of patchlight for bash. scripts/make_help.py writes this file.
_patchlight() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
  local words=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="solve check init plan form-factors relight render compare-solvers convergence crosscheck selftest --help --version"
  else
    case "$command,$before" in
      solve,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      solve,--unit) words="m cm mm in ft" ;;
      solve,--up) words="y z" ;;
      solve,--sides) words="auto front both" ;;
      solve,--picture-quality) words="draft final" ;;
      solve,--map) words="illuminance daylight-factor" ;;
      solve,--method) words="auto pairs rays on-demand" ;;
      solve,--solver) words="jacobi gauss-seidel sor symmetric-gauss-seidel chebyshev progressive overshooting cg deflated-cg gmres bicgstab" ;;
      solve,--estimator) words="auto area point-polygon hemisphere contour" ;;
      check,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      check,--unit) words="m cm mm in ft" ;;
      check,--up) words="y z" ;;
      check,--sides) words="auto front both" ;;
      init,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      init,--unit) words="m cm mm in ft" ;;
      init,--up) words="y z" ;;
      plan,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      plan,--unit) words="m cm mm in ft" ;;
      plan,--up) words="y z" ;;
      plan,--sides) words="auto front both" ;;
      plan,--method) words="auto pairs rays on-demand" ;;
      plan,--estimator) words="auto area point-polygon hemisphere contour" ;;
      form-factors,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      form-factors,--unit) words="m cm mm in ft" ;;
      form-factors,--up) words="y z" ;;
      form-factors,--sides) words="auto front both" ;;
      form-factors,--matrix) words="npy mtx" ;;
      form-factors,--by) words="material object" ;;
      form-factors,--without) words="hidden free far" ;;
      form-factors,--method) words="pairs rays" ;;
      form-factors,--estimator) words="auto area point-polygon hemisphere contour" ;;
      relight,--up) words="y z" ;;
      relight,--picture-quality) words="draft final" ;;
      relight,--map) words="illuminance daylight-factor" ;;
      relight,--solver) words="jacobi gauss-seidel sor symmetric-gauss-seidel chebyshev progressive overshooting cg deflated-cg gmres bicgstab" ;;
      render,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      render,--unit) words="m cm mm in ft" ;;
      render,--up) words="y z" ;;
      render,--picture-quality) words="draft final" ;;
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
      crosscheck,--format) words="obj ply stl off dae ifc gltf glb hbjson rad xml toml" ;;
      crosscheck,--unit) words="m cm mm in ft" ;;
      crosscheck,--up) words="y z" ;;
      crosscheck,--sides) words="auto front both" ;;
      crosscheck,--estimator) words="auto area point-polygon hemisphere contour" ;;
      crosscheck,--method) words="auto pairs rays on-demand" ;;
    esac
    if [ -z "$words" ] && [[ $current == -* ]]; then
      case $command in
        solve) words="-h --help --format --unit --up --confine --set --only --exclude --simplify --maintenance-factor --bands --color-error --no-merge --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges -o --output --ambient-occlusion --html --series --json --picture --false-color --camera --projection --view --size --picture-quality --picture-error --picture-samples --picture-error-map --lightmap --texel --points --points-output --map --map-range --accuracy --time-limit --focus --no-refine --error-bars --no-error-bars --form-factors --method --rays --checkpoint --no-closure --relaxation --solver --tolerance --max-iterations --max-rows --samples --estimator --seed --enable --disable --threads --memory --discard -q --quiet -v --verbose" ;;
        check) words="-h --help --format --unit --up --confine --set --only --exclude --simplify --maintenance-factor --bands --color-error --no-merge --sky --sun --ground --weather --sides --all --json --problems --picture --camera --projection --view --size --ambient-occlusion" ;;
        init) words="-h --help --format --unit --up --confine -o --output" ;;
        plan) words="-h --help --format --unit --up --confine --set --only --exclude --simplify --maintenance-factor --bands --color-error --no-merge --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges --json --accuracy --time-limit --focus --no-refine --error-bars --no-error-bars --method --rays --no-closure --samples --estimator --seed --enable --disable --threads --memory" ;;
        form-factors) words="-h --help --format --unit --up --confine --set --only --exclude --simplify --maintenance-factor --bands --color-error --no-merge --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges --enable --disable -o --output --matrix --by --without --no-closure --method --rays --samples --estimator --seed --threads --memory -q --quiet" ;;
        relight) words="-h --help --set --up --sky --sun --ground --weather --enable --disable -o --output --ambient-occlusion --html --series --json --picture --false-color --camera --projection --view --size --picture-quality --picture-error --picture-samples --picture-error-map --lightmap --texel --points --points-output --map --map-range --no-closure --relaxation --solver --tolerance --max-iterations --max-rows --threads --memory --discard -q --quiet -v --verbose" ;;
        render) words="-h --help --format --unit --up --confine --set --only --exclude --simplify --maintenance-factor --bands --color-error --no-merge --sky --sun --ground --weather --solution -o --output --false-color --camera --projection --view --size --picture-quality --picture-error --picture-samples --picture-error-map --difference --observers --lightmap --texel --html --threads -q --quiet" ;;
        compare-solvers) words="-h --help --format --unit --up --confine --set --only --exclude --simplify --maintenance-factor --bands --color-error --no-merge --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges --enable --disable -o --output --html --solvers --tolerance --max-iterations --no-series --no-closure --relaxation --samples --estimator --seed --threads --memory -q --quiet" ;;
        convergence) words="-h --help --format --unit --up --confine --set --only --exclude --simplify --maintenance-factor --bands --color-error --no-merge --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --enable --disable -o --output --html --sizes --tolerance --no-adaptive --no-estimators --samples --estimator --seed --threads --memory -q --quiet" ;;
        crosscheck) words="-h --help --format --unit --up --confine --set --only --exclude --simplify --maintenance-factor --bands --color-error --no-merge --sky --sun --ground --weather --sides --max-edge --patches --no-contact-lines --graded-edges --enable --disable --paths --sample-patches --margin --json --accuracy --time-limit --focus --no-refine --samples --estimator --seed --method --rays --no-closure --threads --memory -q --quiet" ;;
        selftest) words="-h --help --json --threads" ;;
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
