#!/usr/bin/env bash
# Page layouts side by side: docs/decisions/0001-pages.md is made with this.
#
#   bench/layouts.sh RASTER [BANDLEVELS/PAGESHIFT ...]
#
# Builds the program once per layout in build/layouts/, ingests RASTER, and prints for each: bytes of the file
# and of its pages; pages and bytes read for the whole raster at 50 m, and for a window of 65×65 samples at
# tolerance 0, the median over 25 places.
set -euo pipefail

raster=$(realpath "$1")
shift
cd "$(dirname "$0")/.."
layouts=("${@:-}")
[[ -n ${layouts[0]} ]] || layouts=(3/7 3/6 3/8 2/7 2/6 6/7 1/7)

mkdir -p build/layouts

printf '%-28s %10s %10s %9s | %7s %10s | %7s %9s\n' layout file/kB pages/kB 'bits/smp' pages 'read/kB' pages 'read/kB'
printf '%-28s %10s %10s %9s | %18s | %17s\n' '' '' '' '' 'whole at 50 m' '65×65 at 0 m'
for layout in "${layouts[@]}"; do
  levels=${layout%/*} shift_bits=${layout#*/}
  build=build/layouts/$levels-$shift_bits
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTALUS_BUILD_TESTS=OFF -DTALUS_BUILD_BENCH=OFF \
    -DTALUS_BAND_LEVELS="$levels" -DTALUS_PAGE_SHIFT="$shift_bits" > "$build.log" 2>&1
  cmake --build "$build" --target talus >> "$build.log" 2>&1
  program=$build/app/talus database=$build/layout.talus
  "$program" ingest "$raster" "$database" --overwrite > /dev/null
  "$program" query "$database" --tolerance 50 --json > "$build/whole.json"
  "$program" info "$database" --json > "$build/info.json"
  /usr/bin/python3 - "$program" "$database" "$levels" "$shift_bits" "$build" <<'PYTHON'
import json, os, statistics, subprocess, sys
program, database, levels, shift, build = sys.argv[1:]
info, whole = json.load(open(f'{build}/info.json')), json.load(open(f'{build}/whole.json'))
xmin, ymin, xmax, ymax = info['region']
cols, rows = info['cols'], info['rows']
dx, dy = (xmax - xmin) / (cols - 1), (ymax - ymin) / (rows - 1)
windows = []
for i in range(5):
    for j in range(5):
        col, row = (cols - 65) * (2 * i + 1) // 10, (rows - 65) * (2 * j + 1) // 10
        box = f'--bbox={xmin + col * dx!r},{ymin + row * dy!r},{xmin + (col + 64) * dx!r},{ymin + (row + 64) * dy!r}'
        windows.append(json.loads(subprocess.run([program, 'query', database, '--tolerance', '0', box, '--json'],
                                                 check=True, capture_output=True).stdout))
pages = statistics.median(w['pages_read'] for w in windows)
kilobytes = statistics.median(w['bytes_read'] for w in windows) / 1000
name = f'{levels} levels, {1 << int(shift)}² samples'
page_bytes = info['page_bytes']
print(f"{name:28} {os.path.getsize(database) / 1000:10.0f} {page_bytes / 1000:10.0f} {8 * page_bytes / (cols * rows):9.2f} | "
      f"{whole['pages_read']:7} {whole['bytes_read'] / 1000:10.0f} | {pages:7.0f} {kilobytes:9.1f}", flush=True)
PYTHON
  rm -f "$database"
done
