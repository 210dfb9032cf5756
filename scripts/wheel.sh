#!/usr/bin/env bash
# Makes the source distribution, a wheel from it with LAPACK inside, and tries the wheel where there is no
# compiler and no LAPACK in the path.
#
#   bash scripts/wheel.sh [OUT]     into the folder OUT, default dist
#
# RBSDEM_WHEEL_TESTS=0 leaves the Python tests out. Releases are built by .github/workflows/wheels.yml.
RBSDEM_EXTRA=wheel
out=$(realpath -m "${1:-dist}")
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

cd "$root"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$out"

say "source distribution, and a wheel from it"
python -m build --outdir "$work/dist" . >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "the build failed"; }

say "LAPACK and the libraries of gfortran into the wheel"
python -m auditwheel repair --wheel-dir "$out" "$work"/dist/*.whl >"$work/log" 2>&1 ||
    { cat "$work/log" >&2; fail "auditwheel could not repair the wheel"; }
cp "$work"/dist/*.tar.gz "$out"
wheel=$(ls -t "$out"/rbsdem-*.whl | head -n 1)
say "$(basename "$wheel"), $(du -h "$wheel" | cut -f1)"

say "a bare virtual environment, nothing else in the path"
"$python" -m venv "$work/venv"
bare() { (cd "$work" && env -i HOME="$HOME" LANG=C.UTF-8 MPLBACKEND=Agg PATH="$work/venv/bin" "$@"); }
# pip may need settings of the network that stand in the environment.
"$work/venv/bin/python" -m pip install -q --disable-pip-version-check --only-binary :all: "$wheel[all]"
bare rbsdem --version
bare python - <<'PY'
import shutil
import rbsdem
assert not shutil.which("gfortran") and not shutil.which("cc"), "there is a compiler in the path"
for name, column in rbsdem.peer.paper_columns().items():
    print(f"{name}: first frequency {rbsdem.modes(column).frequency[0]:.2f} Hz")
PY
for file in "$work"/venv/lib/python*/site-packages/rbsdem/{_rbsdem*.so,bin/rbsdem}; do
    outside=$(ldd "$file" | grep -E 'lapack|blas|gfortran|quadmath' | grep -v rbsdem.libs || true)
    [ -z "$outside" ] || fail "$(basename "$file") takes libraries from outside of the wheel: $outside"
done

if [ "${RBSDEM_WHEEL_TESTS:-1}" != 0 ]; then
    say "the Python tests with the wheel"
    # Some packages of the tests come as sources of Python alone.
    "$work/venv/bin/python" -m pip install -q --disable-pip-version-check "$wheel[test]"
    (cd "$root" && env PATH="$work/venv/bin:/usr/bin:/bin" MPLBACKEND=Agg \
        "$work/venv/bin/python" -m pytest -q -n 2 --dist worksteal tests/python)
fi
