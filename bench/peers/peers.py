#!/usr/bin/python3
"""Talus beside GDAL and martini, one window of 1025² samples, one core, warm: time, size and true error.

peers.py PROGRAM FOLDER     PROGRAM is build/release/bench/peers/peers; FOLDER takes what is made and brought

martini (npm package @mapbox/martini, ISC licence) is brought by npm into FOLDER. Where Node, npm or the network is missing,
the rest is measured. All take turns, so that a machine that changes its speed changes it for all. Times are medians of processor
time, which on one core is the clock's where nobody else is at work; ratios by the clock stand beside.
"""
import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

MARTINI = "@mapbox/martini@0.2.0"
TURNS, WARM_UP = 9, 10
TOLERANCES = ["1", "5", "20"]
# Talus as it is, and `keeping`: with a C library that does not give memory back to the system between answers.
KEEPING = {"MALLOC_TRIM_THRESHOLD_": "1000000000", "MALLOC_MMAP_THRESHOLD_": "1000000000"}
MODELS = [("swiss_germany_3s/swiss_germany.vrt", 1024, 2048), ("taiwan_z13/taiwan.vrt", 6144, 9216)]


class Asked:
    """A program that answers a line with a line of numbers."""

    def __init__(self, *command, **variables):
        self.process = subprocess.Popen([str(c) for c in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        env={**os.environ, **variables})

    def __call__(self, *question):
        print(*question, file=self.process.stdin, flush=True)
        line = self.process.stdout.readline()
        if not line:
            sys.exit(f"peers: no answer to '{' '.join(map(str, question))}'")
        return [float(word) for word in line.split()]

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def bring_martini(folder):
    """The module's file, or None with a sentence why not."""
    module = folder / "node_modules/@mapbox/martini/martini.js"
    if not shutil.which("node"):
        print("martini is skipped: there is no node")
        return None
    if not module.exists():
        if not shutil.which("npm"):
            print("martini is skipped: there is no npm to bring it")
            return None
        command = ["npm", "install", "--prefix", str(folder), "--ignore-scripts", "--no-audit", "--no-fund",
                   "--fetch-retries=1", MARTINI]
        brought = subprocess.run(command, capture_output=True, text=True)
        if brought.returncode != 0 or not module.exists():
            errors = [line for line in brought.stderr.splitlines() if "error" in line]
            print("martini is skipped: npm could not bring it:", "; ".join(errors[:2]))
            return None
    return module


def measure(talus, keeping, martini):
    """For each tolerance a dictionary of medians, each of processor time and by the clock; and the yardstick's."""
    rows, copies = {}, []
    for tolerance in TOLERANCES:
        times, row = {}, {}
        for turn in range(-WARM_UP, TURNS):
            now = {"memcpy": talus("memcpy")}
            *now["talus"], row["vertices"], row["triangles"] = talus("talus", tolerance)
            *now["keeping"], _, _ = keeping("talus", tolerance)
            now["float"] = talus("float")
            now["lerc0"] = talus("lerc", "0")
            now["lerc"] = talus("lerc", tolerance)
            if martini:
                *both, row["their_vertices"], row["their_triangles"] = martini("mesh", tolerance)
                now["errors"], now["mesh"] = both[:2], both[2:]
                now["theirs"] = [sum(parts) for parts in zip(now["float"], now["errors"], now["mesh"])]
            if turn >= 0:
                for what, time in now.items():
                    times.setdefault(what, []).append(time)
        for what, taken in times.items():
            row[what] = [statistics.median(each) for each in zip(*taken)]
        copies.append(row["memcpy"][0])
        rows[tolerance] = row
    return rows, statistics.median(copies)


def verdict(what, ours, theirs, must):
    measured = ours[0] / theirs[0]
    print(f"  {what:<38} {ours[0]:7.1f} / {theirs[0]:7.1f} ms = {measured:5.2f}  must <= {must:<4}  "
          f"{'reached' if measured <= must else 'NOT REACHED'}  (by the clock {ours[1] / theirs[1]:.2f})", flush=True)


def compare(program, module, model, col, row, folder):
    talus = Asked(program, model, col, row, folder)
    keeping = Asked(program, model, col, row, folder, **KEEPING)
    heights = folder / "heights.f32"
    voids, = talus("export", heights)
    martini = Asked("node", Path(__file__).parent / "martini.cjs", module, heights) if module else None
    rows, copy = measure(talus, keeping, martini)
    print(f"\n{model.name}, samples {col},{row} to {col + 1024},{row + 1024}, {voids:.0f} of them void"
          f"{' (for martini as high as the one before)' if voids else ''}; memcpy {0.067108864 / copy * 1e3:.1f} GB/s")
    print(f"{'tolerance m':>11}  {'':<8} {'read ms':>8} {'errors ms':>9} {'mesh ms':>8} {'all ms':>8} {'vertices':>9} "
          f"{'triangles':>9} {'true error m':>12}")
    for tolerance, r in rows.items():
        error, uncovered = talus("judge", tolerance)
        print(f"{tolerance:>11}  {'Talus':<8} {'':>8} {'':>9} {'':>8} {r['talus'][0]:8.1f} {r['vertices']:9.0f} "
              f"{r['triangles']:9.0f} {error:12.3f}{f'  {uncovered:.0f} samples uncovered' if uncovered else ''}")
        print(f"{'':>11}  {'  keeping':<8} {'':>7} {'':>9} {'':>8} {r['keeping'][0]:8.1f}")
        if martini:
            mesh = folder / "martini.mesh"
            martini("write", tolerance, mesh)
            error, _ = talus("judge_file", mesh)
            print(f"{'':>11}  {'martini':<8} {r['float'][0]:8.1f} {r['errors'][0]:9.1f} {r['mesh'][0]:8.1f} "
                  f"{r['theirs'][0]:8.1f} {r['their_vertices']:9.0f} {r['their_triangles']:9.0f} {error:12.3f}")
    for tolerance, r in rows.items():
        if martini:
            verdict(f"{tolerance} m, against GDAL and martini", r["talus"], r["theirs"], 0.08)
            verdict(f"{tolerance} m, the same, keeping memory", r["keeping"], r["theirs"], 0.08)
        verdict(f"{tolerance} m, against GDAL, MAX_Z_ERROR=0", r["talus"], r["lerc0"], 1.5)
        verdict(f"{tolerance} m, against GDAL, MAX_Z_ERROR={tolerance}", r["talus"], r["lerc"], 1.5)
    talus.end()
    keeping.end()
    if martini:
        martini.end()


def main():
    program, folder = sys.argv[1], Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    models = Path(os.environ.get("TALUS_DEM_DIR", "../shared/dem"))
    module = bring_martini(folder)
    there = [model for model in MODELS if (models / model[0]).exists()]
    if not there:
        print("peers is skipped: TALUS_DEM_DIR has none of its models")
    for name, col, row in there:  # databases are made with all cores
        Asked(program, models / name, col, row, folder).end()
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    for name, col, row in there:
        compare(program, module, models / name, col, row, folder)


if __name__ == "__main__":
    main()
