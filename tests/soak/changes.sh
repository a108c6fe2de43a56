#!/usr/bin/env bash
# Inputs that change, updates that meet, kills, and damaged .part files, at random: see changes.py.
#
#   tests/soak/changes.sh TALUS [RUNS [SIDE [SEED [KIND...]]]]     100 runs of each kind, tiles of 1200 samples a side
#
# Kinds: resume_after_changes updates_that_meet killed_updates damaged_part.
#
# Needs TALUS_DEM_DIR with swiss_germany_3s, python3-gdal and python3-numpy.
set -euo pipefail
: "${TALUS_DEM_DIR:?names no folder of real terrain}"
exec /usr/bin/python3 "$(dirname "$0")/changes.py" "$@"
