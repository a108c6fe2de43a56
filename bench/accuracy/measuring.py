"""Windows of real models, and what programs say of them: ours, GDAL's and martini."""
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

import numpy
from osgeo import gdal

sys.path.append(str(Path(__file__).parent.parent / "peers"))
from peers import bring_martini  # noqa: E402  it stands there

gdal.UseExceptions()
SIDE = 512
MARGIN = 64  # samples around a window, where it is asked for amid others
COARSE = ([0.5, 1, 2, 5, 10, 20, 50], [1, 5, 20], [round(0.3 * 1.25**i, 3) for i in range(24)])
LIDAR = ([0.05, 0.1, 0.2, 0.5, 1, 2, 5, 20], [0.05, 0.1, 0.2, 0.5, 1, 5], [round(0.015 * 1.25**i, 4) for i in range(32)])
# Windows of 513² samples without voids: name, file, first column and row (None: the roughest there is), and tolerances: those
# that are timed, those of the tables, and those to see which tolerance of one kind is worth that of another.
WINDOWS = [("S36E149, 90 m, hills", "srtm3_S36E149.tif", 88, 88, COARSE),
           ("Kenya, 38 m, one mountain", "kenya_central_z11.tif", 3712, 2944, COARSE),
           ("Taiwan, 19 m, mountains", "taiwan_z13/taiwan.vrt", 5000, 10000, COARSE),
           ("Swiss Alps, 90 m", "swiss_germany_3s/swiss_germany.vrt", None, None, COARSE),
           ("bigtujunga, 30 m, canyons", "bigtujunga_30m_utm11.tif", 64, 64, COARSE),
           ("gabilan, 1 m, lidar", "gabilan.bil", 128, 128, LIDAR)]
KINDS = {"exact": [], "perpendicular": ["--metric", "perpendicular"]}  # that databases have; error_kinds counts the others


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


class Window:
    """Cut out as a raster of its own, and with a margin around it."""

    def __init__(self, name, file, col, row, tolerances, scratch):
        self.name, self.file, (self.timed, self.shown, self.fine) = name, file, tolerances
        source = models() / file
        self.col, self.row = (col, row) if col is not None else without_voids(source)
        stem = name.split(",")[0].replace(" ", "_")
        self.cut, self.wide = scratch / f"{stem}.tif", scratch / f"{stem}-wide.tif"
        for out, margin in ((self.cut, 0), (self.wide, MARGIN)):
            if not out.exists():
                side = SIDE + 1 + 2 * margin
                gdal.Translate(str(out), str(source), srcWin=[self.col - margin, self.row - margin, side, side])


class Bench:
    """Programs, a folder for what they make, and the windows that are there."""

    def __init__(self, build):
        self.build = build
        self.talus, self.error_kinds = build / "app/talus", build / "bench/accuracy/error_kinds"
        self.scratch = build / "kept/accuracy"
        self.scratch.mkdir(parents=True, exist_ok=True)
        peers = build / "kept/peers"
        peers.mkdir(parents=True, exist_ok=True)
        self.martini = bring_martini(peers.resolve())
        self.windows = []
        for window in WINDOWS:
            if (models() / window[1]).exists():
                self.windows.append(Window(*window, self.scratch))
            else:
                print(f"{window[0]} is left out: no {window[1]}")

    def database(self, raster, kind="exact"):
        """Made by this very program."""
        file = raster.with_name(f"{raster.stem}-{kind}.talus")
        if not file.exists() or file.stat().st_mtime < self.talus.stat().st_mtime:
            run(self.talus, "ingest", raster, file, "--overwrite", "--progress", "none", *KINDS[kind])
        return file

    def answer(self, database, *words):
        """What query says, and the bytes of its stream."""
        stream = self.scratch / "answer.rqt"
        made = json.loads(run(self.talus, "query", database, *words, "-o", stream, "--json"))
        return {**made, "bytes": stream.stat().st_size}

    def counted(self, raster, tolerances, side=SIDE, col=0, row=0):
        """By plain loops, of each kind: rows of tolerance, vertices, triangles, true_error."""
        found = {}
        for line in map(json.loads, run(self.error_kinds, raster, col, row, side, *tolerances).splitlines()):
            found.setdefault(line["kind"], []).append(line)
        return found

    def measured(self, raster, kind, tolerances):
        """By `talus accuracy`: falling tolerance."""
        return json.loads(run(self.talus, "accuracy", self.database(raster, kind), "--against", raster, "--json", "--tolerances",
                              ",".join(map(str, tolerances))))["points"]


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


