#!/usr/bin/env bash
# Build the compiled part with the address and undefined-behaviour sanitizers, and run its tests on that build.
# Usage: tests/sanitize.sh PYTHON
set -euo pipefail
python=$1
cd "$(dirname "$0")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r motionedit tests pyproject.toml "$folder/"
rm -f "$folder"/motionedit/core/_compiled*
headers=$("$python" -c 'import sysconfig; print(sysconfig.get_paths()["include"])')
sources=$("$python" -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["tool"]["setuptools"]["ext-modules"][0]["sources"])')
# shellcheck disable=SC2086  # several files
gcc -shared -fPIC -std=c11 -O1 -g -Wall -Wextra -Werror -fsanitize=address,undefined -fno-sanitize-recover=all \
  -fno-omit-frame-pointer -I"$headers" $sources -o "$folder/motionedit/core/_compiled.abi3.so"
# Python itself leaks by design; its own allocator would hide overruns.
export ASAN_OPTIONS=detect_leaks=0 PYTHONMALLOC=malloc
export LD_PRELOAD="$(gcc -print-file-name=libasan.so)"
cd "$folder"
"$python" -c "from motionedit.core import _compiled"  # else the tests would be skipped
# What holds the numpy solver beside the compiled one is left out where other tests give that the same frames: it takes
# two thirds of the time, and numpy's part of it has no sanitizer.
rooms=tests/unit/core/priorities
cones=$rooms/solver/test_cones.py::test_joints_stay_within_their_cones_and_the_feet_stay_where_they_are
"$python" -m pytest -q -p no:cacheprovider -n "${JOBS:-2}" \
  -k "not hold_joints_alike and not keep_limits_alike and not move_a_body_alike and not keep_cones_alike" \
  --deselect "$cones[numpy]" \
  $rooms/solver/test_compiled.py $rooms/solver/test_compiled_buffers.py $rooms/solver/test_compiled_one_sided.py \
  $rooms/solver/test_compiled_postures.py $rooms/solver/test_cones.py $rooms/solver/test_few_channels.py \
  $rooms/continuity/test_compiled_smoothing.py \
  tests/unit/core/test_rotations.py tests/unit/core/test_euler.py tests/unit/core/test_kinematics.py \
  tests/unit/core/body/test_contacts.py tests/unit/core/body/test_in_one_loop.py tests/unit/core/body/test_ranges.py \
  tests/unit/core/feet/test_measures.py tests/unit/core/feet/test_phases.py tests/unit/core/feet/test_stance.py \
  tests/unit/core/timeline/test_interpolation.py tests/unit/core/timeline/test_sampled_rows.py \
  tests/properties/test_compiled_text.py tests/bvh_files/test_short_edits.py
