#!/usr/bin/env bash
# A country's worth of samples through little memory: a virtual raster that repeats a real one to 38,000 × 38,000 and
# more is ingested below a limit, and so is one piece of it. Prints memory and rate over time, and what was reached.
#
#   tests/soak/ingest.sh TALUS [ACROSS [MEMORY]]     11 pieces a side and 512MiB, unless said otherwise
#
# Needs TALUS_DEM_DIR with swiss_germany_3s, and about 3 GB below TMPDIR.
set -euo pipefail

talus=$(realpath "$1")
across=${2:-11} memory=${3:-512MiB}
: "${TALUS_DEM_DIR:?names no folder of real terrain}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

gdal_translate -q -co TILED=YES -co COMPRESS=ZSTD "$TALUS_DEM_DIR/swiss_germany_3s/swiss_germany.vrt" "$work/piece.tif"
/usr/bin/python3 - "$work" "$across" <<'END'
import sys
folder, across = sys.argv[1], int(sys.argv[2])
side = 3600 * across + 1
with open(f"{folder}/country.vrt", "w") as vrt:
    vrt.write(f'<VRTDataset rasterXSize="{side}" rasterYSize="{side}">\n'
              '<SRS>EPSG:3035</SRS><GeoTransform>0, 90, 0, 0, 0, -90</GeoTransform>\n'
              '<VRTRasterBand dataType="Int16" band="1"><NoDataValue>-32768</NoDataValue>\n')
    for y in range(across):
        for x in range(across):
            vrt.write('<ComplexSource><SourceFilename relativeToVRT="1">piece.tif</SourceFilename>'
                      '<SourceBand>1</SourceBand><NODATA>-32768</NODATA>'
                      f'<SrcRect xOff="0" yOff="0" xSize="3601" ySize="3601"/>'
                      f'<DstRect xOff="{3600 * x}" yOff="{3600 * y}" xSize="3601" ySize="3601"/></ComplexSource>\n')
    vrt.write('</VRTRasterBand></VRTDataset>\n')
print(f"{side} x {side} = {side * side / 1e9:.2f}e9 samples")
END

# run RASTER DATABASE: ingests, printing resident memory and progress every ten seconds.
run() {
  "$talus" ingest "$1" "$2" --memory "$memory" --progress=json --json --overwrite >"$work/report.json" 2>"$work/progress" &
  local pid=$! peak=0 now next=0
  while kill -0 $pid 2>/dev/null; do
    now=$(awk '/VmHWM/ {print $2}' "/proc/$pid/status" 2>/dev/null || true)
    if [[ -n $now ]]; then peak=$now; fi
    if ((SECONDS >= next)) && [[ -s $work/progress ]]; then
      next=$((SECONDS + 10))
      tail -n 1 "$work/progress" | /usr/bin/python3 -c '
import json, sys
try: p = json.loads(sys.stdin.readline())
except ValueError: sys.exit()
rate = p["samples"] / 1e6 / max(p["seconds"], 1e-9)
print("  %7.1f s  %5.1f %%  %6.1f Msamples/s  peak %6.1f MiB"
      % (p["seconds"], 100 * p["fraction"], rate, int(sys.argv[1]) / 1024))' "$peak"
    fi
    sleep 0.1
  done
  wait $pid
  echo "$peak" >"$work/peak"
}

echo "== one piece"
run "$work/piece.tif" "$work/piece.talus"
cp "$work/report.json" "$work/piece.json"
echo "== all of it"
run "$work/country.vrt" "$work/country.talus"
/usr/bin/python3 - "$work" "$memory" <<'END'
import json, sys
folder, memory = sys.argv[1:]
piece, country = (json.load(open(f"{folder}/{name}.json")) for name in ("piece", "report"))
peak = int(open(f"{folder}/peak").read()) / 1024
def per_sample(r): return r["seconds"] / (r["cols"] * r["rows"]) * 1e9
print(f"one piece  {piece['cols'] * piece['rows'] / 1e6:8.1f} Msamples  {per_sample(piece):6.1f} ns a sample")
print(f"all of it  {country['cols'] * country['rows'] / 1e6:8.1f} Msamples  {per_sample(country):6.1f} ns a sample, "
      f"{per_sample(country) / per_sample(piece):.2f} times that of a piece (must: 1.3)")
print(f"bits a sample {country['bytes'] * 8 / (country['cols'] * country['rows']):.2f}; pages read back {country['pages_read_back']}")
print(f"peak resident memory {peak:.1f} MiB under --memory {memory}")
END
echo "== the file is whole, and answers are"
"$talus" verify "$work/country.talus" --json | tail -n 1 | head -c 300
echo
