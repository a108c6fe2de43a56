#!/usr/bin/python3
"""Measures what docs/accuracy.md says, and writes it there: tables between its marks, pictures beside it.

    page.py BUILD [PART...]     BUILD: build/release; parts: ingest windows kinds paper bytes; without any: all

Between `<!-- measured: PART -->` and `<!-- end -->` everything is replaced; all other words are the author's. Real models are
found through TALUS_DEM_DIR; those that are not there are left out, and so is martini where there is no Node or npm to bring it.
"""
import json
import os
import re
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy
from osgeo import gdal

from pictures import picture

sys.path.append(str(Path(__file__).parent.parent / "peers"))
from peers import bring_martini  # noqa: E402  it stands there

gdal.UseExceptions()
SIDE = 512
# Windows of 513² samples without voids: name, file, first column and row; None: the roughest there is.
WINDOWS = [("S36E149, 90 m, hills", "srtm3_S36E149.tif", 88, 88),
           ("Kenya, 38 m, one mountain", "kenya_central_z11.tif", 3712, 2944),
           ("Taiwan, 19 m, mountains", "taiwan_z13/taiwan.vrt", 5000, 10000),
           ("Swiss Alps, 90 m", "swiss_germany_3s/swiss_germany.vrt", None, None),
           ("bigtujunga, 30 m, canyons", "bigtujunga_30m_utm11.tif", 64, 64),
           ("gabilan, 1 m, lidar", "gabilan.bil", 128, 128)]
KINDS = {"exact": ["--error", "exact"], "nested": ["--error", "nested"], "midpoint": ["--error", "midpoint", "--no-guarantee"],
         "perpendicular": ["--metric", "perpendicular"]}
TOLERANCES = [0.5, 1, 2, 5, 10, 20, 50]  # of answers that are timed
FINE = [round(0.3 * 1.25**i, 3) for i in range(24)]  # to see which tolerance of one kind is worth that of another
PAPER = [("Interlaken, 25 m, mountains", "dhm25/dhm25_interlaken_lv95.bt", 64, 64),
         ("bigtujunga, 30 m, mountains", "bigtujunga_30m_utm11.tif", 64, 64), ("S36E149, 90 m, hills", "srtm3_S36E149.tif", 512, 512)]
PUBLISHED = [("Albis, 25 m, hills", [25921, 19773, 11636, 4664, 1789]),
             ("Matterhorn, 25 m, mountains", [25921, 22492, 17156, 10492, 6367])]


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"page: {' '.join(map(str, words))}: {done.stderr.strip()}")
    return done.stdout


def models():
    return Path(os.environ.get("TALUS_DEM_DIR", "../shared/dem"))


def without_voids(file):
    """Where the roughest window stands, at multiples of 64, in which all is data."""
    dataset = gdal.Open(str(file))
    band = dataset.GetRasterBand(1)
    heights, void = band.ReadAsArray(), band.GetNoDataValue()
    best = None
    for row in range(0, heights.shape[0] - SIDE, 64):
        for col in range(0, heights.shape[1] - SIDE, 64):
            part = heights[row:row + SIDE + 1, col:col + SIDE + 1]
            if void is not None and (part == void).any():
                continue
            if best is None or numpy.ptp(part) > best[0]:
                best = (numpy.ptp(part), col, row)
    return best[1:]


class Bench:
    """Programs, a folder for what they make, and the windows that are there, cut out as rasters of their own."""

    def __init__(self, build):
        self.talus, self.error_kinds = build / "app/talus", build / "bench/accuracy/error_kinds"
        self.scratch = build / "kept/accuracy"
        self.scratch.mkdir(parents=True, exist_ok=True)
        peers = build / "kept/peers"
        peers.mkdir(parents=True, exist_ok=True)
        self.martini = bring_martini(peers.resolve())
        self.windows = []
        for name, file, col, row in WINDOWS:
            if not (models() / file).exists():
                print(f"{name} is left out: no {file}")
                continue
            if col is None:
                col, row = without_voids(models() / file)
            cut = self.scratch / (name.split(",")[0].replace(" ", "_") + ".tif")
            if not cut.exists():
                gdal.Translate(str(cut), str(models() / file), srcWin=[col, row, SIDE + 1, SIDE + 1])
            self.windows.append((name, cut))

    def database(self, cut, kind):
        file = cut.with_name(f"{cut.stem}-{kind}.talus")
        if not file.exists():
            run(self.talus, "ingest", cut, file, "--progress", "none", *KINDS[kind])
        return file

    def counted(self, cut, tolerances, side=SIDE, col=0, row=0):
        """By plain loops, of each kind: rows of tolerance, vertices, triangles, true_error."""
        found = {}
        for line in map(json.loads, run(self.error_kinds, cut, col, row, side, *tolerances).splitlines()):
            found.setdefault(line["kind"], []).append(line)
        return found

    def measured(self, cut, kind):
        """By `talus accuracy`: falling tolerance."""
        words = [self.talus, "accuracy", self.database(cut, kind), "--against", cut, "--json", "--tolerances",
                 ",".join(map(str, TOLERANCES)), "--time", "10ms"]
        points = json.loads(run(*words))["points"]
        return [p for p in points if p["tolerance"] in TOLERANCES]


class Martini:
    """Asked as bench/peers asks it: a line of numbers for a line."""

    def __init__(self, bench, cut):
        self.bench, self.cut = bench, cut
        heights = gdal.Open(str(cut)).ReadAsArray().astype(numpy.float32)
        heights.tofile(bench.scratch / "heights.f32")
        self.node = subprocess.Popen(["node", "bench/peers/martini.cjs", str(bench.martini), str(bench.scratch / "heights.f32")],
                                     stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for _ in range(10):  # until it is as fast as it gets
            self.ask("mesh 1")

    def ask(self, question):
        print(question, file=self.node.stdin, flush=True)
        return [float(word) for word in self.node.stdout.readline().split()]

    def measured(self, tolerances):
        """By the clock: errors and mesh. In rounds over all tolerances: a burst of another program spoils none of them."""
        rounds = [[self.ask(f"mesh {t}") for t in tolerances] for _ in range(15)]
        rows = []
        for answers, tolerance in zip(zip(*rounds), tolerances):
            mesh = self.bench.scratch / "martini.mesh"
            self.ask(f"write {tolerance} {mesh}")
            error = json.loads(run(self.bench.error_kinds, self.cut, 0, 0, SIDE, "--judge", mesh))["true_error"]
            rows.append({"tolerance": tolerance, "vertices": answers[0][4], "largest_error": error,
                         "warm_seconds": statistics.median(a[1] + a[3] for a in answers) / 1000})
        return rows

    def end(self):
        self.node.stdin.close()
        self.node.wait()


def share(value, of):
    return f"{100 * value / of - 100:+.0f} %"


# ---- parts of the page -----------------------------------------------------------------------------------------


def ingest(bench, folder):
    """What kinds cost when a database is made: all take turns, each into a file of its own."""
    rounds = 3
    lines = ["| ingest, end to end | " + " | ".join(KINDS) + " |", "|---|" + "---|" * len(KINDS)]
    for name, file in (("Taiwan, 268 M samples", "taiwan_z13/taiwan.vrt"), ("Kenya, 40 M samples", "kenya_central_z11.tif")):
        if not (models() / file).exists():
            continue
        seconds, bytes_ = {kind: [] for kind in KINDS}, {}
        for turn in range(rounds):
            for kind, words in KINDS.items():
                if kind == "perpendicular" and (turn > 0 or file.endswith(".vrt")):
                    continue  # takes long, and its ratio is no matter of per cents
                out = bench.scratch / "ingested.talus"
                made = json.loads(run(bench.talus, "ingest", models() / file, out, "--overwrite", "--json", "--progress", "none", *words))
                out.unlink()
                seconds[kind].append(made["seconds"])
                bytes_[kind] = made["bytes"]
        base = statistics.median(seconds["midpoint"])
        lines.append(f"| {name}: time, midpoint = 1 | " + " | ".join(f"{statistics.median(s) / base:.2f}" if s else "" for s in seconds.values()) + " |")
        lines.append("| bytes a sample, midpoint = 1 | " + " | ".join(f"{bytes_[kind] / bytes_['midpoint']:.2f}" if kind in bytes_ else "" for kind in KINDS) + " |")
        print(f"{name}: {seconds}", flush=True)
    return lines


def windows(bench, folder):
    """Error against vertices, time and bytes, of databases of each kind and of the peers."""
    over_vertices, over_time = [], []
    lines = ["| window of 513² | asked | exact: vertices | time | bytes | nested: vertices | midpoint: vertices | true error | perpendicular: vertices | true error | martini: vertices | time | true error |",
             "|---" * 13 + "|"]
    for name, cut in bench.windows:
        found = {kind: bench.measured(cut, kind) for kind in KINDS}
        if bench.martini:
            martini = Martini(bench, cut)
            found["martini"] = martini.measured(sorted(TOLERANCES, reverse=True))
            martini.end()
        curve = lambda kind, cost: [(r[cost], r["largest_error"]) for r in found[kind] if r["largest_error"] > 0]
        over_vertices.append((name, "vertices", "largest true error, m", {kind: curve(kind, "vertices") for kind in found}))
        over_time.append((name, "ms", "largest true error, m",
                          {kind: [(1000 * s, e) for s, e in curve(kind, "warm_seconds")] for kind in found}))
        for tolerance in (1, 5, 20):
            at = {kind: next(r for r in rows if r["tolerance"] == tolerance) for kind, rows in found.items()}
            exact = at["exact"]
            row = [name if tolerance == 1 else "", f"{tolerance} m", f"{exact['vertices']:,}", "1", f"{exact['bytes'] / 1000:,.1f} kB",
                   share(at["nested"]["vertices"], exact["vertices"])]
            for kind in ("midpoint", "perpendicular"):
                row += [share(at[kind]["vertices"], exact["vertices"]), f"{at[kind]['largest_error']:.3g} m"]
            if "martini" in at:
                theirs = at["martini"]
                row += [share(theirs["vertices"], exact["vertices"]), f"{theirs['warm_seconds'] / exact['warm_seconds']:.1f} x",
                        f"{theirs['largest_error']:.3g} m"]
            else:
                row += ["", "", ""]
            lines.append("| " + " | ".join(row) + " |")
        print(f"{name}: answers", flush=True)
    legend = [(kind, kind) for kind in KINDS] + [("martini", "martini, without reading the file")]
    picture(folder / "vertices.svg", over_vertices, [*legend[:-1], ("martini", "martini")] if bench.martini else legend)
    picture(folder / "time.svg", over_time, legend)
    return lines


def kinds(bench, folder):
    """What a kept error takes: the fewest vertices of each kind whose mesh really lies within it."""
    lines = ["| window of 513² | really within | exact | nested | midpoint | asked at | perpendicular | asked at | exact, 8-bit codes | 16-bit codes |",
             "|---" * 10 + "|"]
    for name, cut in bench.windows:
        found = bench.counted(cut, sorted({*FINE, 1, 5, 20}))
        for tolerance in (1, 5, 20):
            at = lambda kind: next(r for r in found[kind] if r["tolerance"] == tolerance)
            exact = at("exact")["vertices"]

            def least(kind):
                kept = [r for r in found[kind] if r["true_error"] <= tolerance]
                if not kept:
                    return f"not at {FINE[0]:g} m", ""
                best = min(kept, key=lambda r: r["vertices"])
                return share(best["vertices"], exact), f"{best['tolerance']:g} m"

            lines.append("| " + " | ".join([name if tolerance == 1 else "", f"{tolerance} m", f"{exact:,}", share(at("nested")["vertices"], exact),
                                           *least("midpoint"), *least("perpendicular"), share(at("exact8")["vertices"], exact),
                                           f"{100 * at('exact16')['vertices'] / exact - 100:+.2f} %"]) + " |")
        print(f"{name}: kinds", flush=True)
    return lines


def paper(bench, folder):
    """[P98], Table 1: its metric, its rule."""
    lines = ["| 161 × 161 samples | 0 m | 1 m | 2 m | 5 m | 10 m |", "|---|---|---|---|---|---|"]
    show = lambda counts: " | ".join(f"{c:,} ({100 * c / 25921:.0f} %)" for c in counts)
    lines += [f"| {name}, published | {show(counts)} |" for name, counts in PUBLISHED]
    for name, file, col, row in PAPER:
        if not (models() / file).exists():
            continue
        found = bench.counted(models() / file, [0, 1, 2, 5, 10], 160, col, row)["paper"]
        lines.append(f"| {name}, here | {show([r['vertices'] for r in found])} |")
        lines.append("| the same, true vertical error | " + " | ".join(f"{r['true_error']:.3g} m" for r in found) + " |")
    return lines


def overviews(cut, scratch):
    """GDAL's averaged overviews: bytes, and the largest distance of a sample from them, interpolated bilinearly."""
    heights = gdal.Open(str(cut)).ReadAsArray().astype(float)
    predictor = 2 if heights.dtype.kind == "i" else 3
    rows = []
    for factor in (2, 4, 8, 16):
        size = {"width": max(1, heights.shape[1] // factor), "height": max(1, heights.shape[0] // factor)}
        small, large = scratch / "small.tif", scratch / "large.tif"
        gdal.Translate(str(small), str(cut), resampleAlg="average", outputType=gdal.GDT_Float32, **size,
                       creationOptions=["COMPRESS=ZSTD", f"PREDICTOR={predictor}", "TILED=YES"])
        gdal.Translate(str(large), str(small), resampleAlg="bilinear", width=heights.shape[1], height=heights.shape[0])
        there = gdal.Open(str(large)).ReadAsArray().astype(float)
        rows.append((small.stat().st_size, float(numpy.abs(heights - there).max())))
    return rows


def bytes_(bench, folder):
    """Streams of each mode of heights beside LERC at the same bound, and overviews."""
    modes = {"exact": [], "bounded": [], "fitted": [], "finely fitted": ["--quantum"], "dense": []}
    lines = ["| window of 513² | asked | " + "".join(f"{mode}: vertices | kB | " for mode in modes) + "LERC_ZSTD, kB |", "|---" * 13 + "|"]
    panels = []
    for name, cut in bench.windows:
        database, stream = bench.database(cut, "exact"), bench.scratch / "answer.rqt"
        curves = {**{mode: [] for mode in modes}, "LERC": []}
        for tolerance in (0.5, 1, 2, 5, 10, 20, 50):
            row = [name if tolerance == 1 else "", f"{tolerance:g} m"]
            for mode, quantum in modes.items():
                words = ["--heights", mode.split()[-1], *quantum, *([tolerance / 20] if quantum else [])]
                made = json.loads(run(bench.talus, "query", database, "--tolerance", tolerance, *words, "-o", stream, "--json"))
                curves[mode].append((stream.stat().st_size, tolerance))
                exact = made["vertices"] if mode == "exact" else exact
                row += [f"{made['vertices']:,}" if mode == "exact" else share(made["vertices"], exact), f"{stream.stat().st_size / 1000:,.1f}"]
            lerc = bench.scratch / "lerc.tif"
            gdal.Translate(str(lerc), str(cut), creationOptions=["COMPRESS=LERC_ZSTD", f"MAX_Z_ERROR={tolerance}", "TILED=YES"])
            curves["LERC"].append((lerc.stat().st_size, tolerance))
            if tolerance in (1, 5, 20):
                lines.append("| " + " | ".join([*row, f"{lerc.stat().st_size / 1000:,.1f}"]) + " |")
        del curves["finely fitted"]  # for triangles, not for bytes
        curves["overviews"] = overviews(cut, bench.scratch)
        panels.append((name, "bytes", "largest error, m", curves))
        print(f"{name}: bytes", flush=True)
    picture(folder / "bytes.svg", panels,
            [("exact", "exact heights"), ("bounded", "bounded"), ("fitted", "fitted"), ("dense", "dense"), ("LERC", "LERC_ZSTD"),
             ("overviews", "GDAL overviews at 1/2 to 1/16, whose error nobody states")])
    return lines


PARTS = {"ingest": ingest, "windows": windows, "kinds": kinds, "paper": paper, "bytes": bytes_}


def main():
    build, wanted = Path(sys.argv[1]).resolve(), sys.argv[2:] or list(PARTS)
    unknown = [part for part in wanted if part not in PARTS]
    if unknown:
        sys.exit(f"page: no part {unknown[0]}: there are {' '.join(PARTS)}")
    page = Path("docs/accuracy.md")
    folder = page.parent / "accuracy"
    folder.mkdir(exist_ok=True)
    bench = Bench(build)
    for part in wanted:
        begun = time.monotonic()
        lines = PARTS[part](bench, folder)
        text, mark = page.read_text(), f"<!-- measured: {part} -->"
        if mark not in text:
            sys.exit(f"page: {page} has no mark {mark}")
        page.write_text(re.sub(re.escape(mark) + r".*?<!-- end -->", lambda _: mark + "\n" + "\n".join(lines) + "\n<!-- end -->", text, flags=re.S))
        print(f"{part}: written, {time.monotonic() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    main()
