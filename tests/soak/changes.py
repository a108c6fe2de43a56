"""Exit 0 only if the database is right.

Four kinds of accident happen to a mosaic of nine tiles, at random moments. Whenever a writer exits with 0, the database
must be sound and equal, sample by sample, one made of the files as they are, or of the updates that exited 0 in an order.
Prints what happened how often; exits with 1 and leaves the folder if anything was wrong.
"""
import hashlib
import itertools
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy
from osgeo import gdal

gdal.UseExceptions()
TALUS = os.path.abspath(sys.argv[1])
RUNS = int(sys.argv[2]) if len(sys.argv) > 2 else 100
SIDE = int(sys.argv[3]) if len(sys.argv) > 3 else 1200
SEED = int(sys.argv[4]) if len(sys.argv) > 4 else 1
KINDS = sys.argv[5:]  # names of the accidents; none: all
dice = random.Random(SEED)
counts, wrongs = Counter(), []
work = Path(tempfile.mkdtemp(prefix="talus-changes-"))
os.chdir(work)

mosaic = gdal.Open(os.environ["TALUS_DEM_DIR"] + "/swiss_germany_3s/swiss_germany.vrt")
ORIGIN, CRS = mosaic.GetGeoTransform(), mosaic.GetProjection()
NODATA = -32768
GROUND = mosaic.ReadAsArray(0, 0, 3 * SIDE, 3 * SIDE).astype(numpy.int16)


def write(name, samples, col, row, driver="GTiff"):
    """A raster in its place; the name appears in one step or not, as programs do it."""
    made = gdal.GetDriverByName("GTiff").Create("w.tif", samples.shape[1], samples.shape[0], 1, gdal.GDT_Int16)
    o = ORIGIN
    made.SetGeoTransform((o[0] + col * o[1], o[1], 0, o[3] + row * o[5], 0, o[5]))
    made.SetProjection(CRS)
    made.GetRasterBand(1).SetNoDataValue(NODATA)
    made.GetRasterBand(1).WriteArray(samples)
    made = None
    if driver != "GTiff":
        gdal.GetDriverByName(driver).CreateCopy("w.bil", gdal.Open("w.tif"))
        os.remove("w.tif")
        for side in Path(".").glob("w.*"):
            os.replace(side, Path(name).with_suffix("".join(side.suffixes)))
    else:
        os.replace("w.tif", name)


def make_inputs(kind):
    """The mosaic as a folder of tiles, a virtual raster over them, or a raw file."""
    shutil.rmtree("in", ignore_errors=True)
    os.mkdir("in")
    if kind == "raw":
        write("in/all.bil", GROUND, 0, 0, "EHdr")
        return ["in/all.bil"], ["in/all.bil", "in/all.hdr"]
    tiles = []
    for y, x in itertools.product(range(3), range(3)):
        tiles.append(f"in/t{y}{x}.tif")
        write(tiles[-1], GROUND[y * SIDE:(y + 1) * SIDE, x * SIDE:(x + 1) * SIDE], x * SIDE, y * SIDE)
    if kind == "folder":
        return ["in"], tiles
    gdal.BuildVRT("in/all.vrt", tiles)
    return ["in/all.vrt"], tiles


def change(file):
    """Something happens to a file; says what. Half of it leaves the bytes as they are."""
    what = dice.choice(["nothing", "touch", "copy", "higher", "one sample", "one byte"])
    if what == "touch":
        os.utime(file)
    elif what == "copy":
        shutil.copy(file, "copy")
        os.replace("copy", file)
    elif what == "one byte":
        size = os.path.getsize(file)
        with open(file, "r+b") as f:
            f.seek(dice.randrange(size // 2, size))
            byte = f.read(1)
            f.seek(-1, 1)
            f.write(bytes([byte[0] ^ 1]))
    elif what != "nothing" and file.endswith(".hdr"):
        text = open(file).read()
        open(file, "w").write(text + "\n")
    elif what != "nothing":
        opened = gdal.Open(file, gdal.GA_Update)
        samples = opened.ReadAsArray()
        if what == "higher":
            samples[samples != NODATA] += 500
        else:
            samples[dice.randrange(samples.shape[0]), dice.randrange(samples.shape[1])] = dice.randrange(4000)
        opened.GetRasterBand(1).WriteArray(samples)
        opened = None
    return what


def start(*arguments):
    return subprocess.Popen([TALUS, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def run(*arguments):
    process = start(*arguments)
    out, err = process.communicate()
    return process.returncode, out, err


def expect(holds, what):
    if not holds:
        wrongs.append(what)
        print("WRONG:", what, flush=True)
        shutil.copytree(".", f"../{work.name}-wrong-{len(wrongs)}", dirs_exist_ok=True)


def is_right(database, sources):
    code, out, err = run("verify", database, "--against", *sources)
    return code == 0, out + err


def forget(*names):
    for name in names:
        if os.path.exists(name):
            os.remove(name)


def seconds_of(*arguments):
    begun = time.monotonic()
    code, _, err = run(*arguments)
    assert code == 0, err
    return time.monotonic() - begun


def killed_somewhere(seconds, arguments, sent):
    """Ends a writer at a random moment; returns its exit code, negative for a signal it died of."""
    process = start(*arguments)
    time.sleep(dice.uniform(0, seconds))
    process.send_signal(sent)
    process.communicate()
    return process.returncode


def resume_after_changes():
    inputs, files = make_inputs(dice.choice(["folder", "vrt", "raw"]))
    forget("a.talus", "a.talus.part")
    options = ["--threads", dice.choice([1, 2]), "--memory", dice.choice(["300MiB", "1GiB"])]
    seconds = seconds_of("ingest", *inputs, "a.talus", *options)
    forget("a.talus")
    if dice.random() < 0.3:  # not killed: a file changes while it is read
        process = start("ingest", *inputs, "a.talus", *options)
        shutil.rmtree("before", ignore_errors=True)
        shutil.copytree("in", "before")
        time.sleep(dice.uniform(0, seconds))
        what = change(dice.choice(files))
        _, err = process.communicate()
        code, when = process.returncode, "during"
    else:
        for _ in range(dice.choice([1, 1, 2])):
            killed_somewhere(seconds, ["ingest", *inputs, "a.talus", *options, "--resume", "--overwrite"],
                             dice.choice([signal.SIGINT, signal.SIGINT, signal.SIGKILL]))
        forget("a.talus")
        what, when = change(dice.choice(files)), "between"
        code, _, err = run("ingest", *inputs, "a.talus", *options, "--resume")
    counts[f"resume: {what} {when}: exit {code}"] += 1
    expect(code in (0, 1, 2, 3), f"resume: exit {code}, {err}")
    if code == 0:
        right, said = is_right("a.talus", inputs)
        if not right and when == "during":  # after the last look, then: what was read is what was there
            right, _ = is_right("a.talus", [name.replace("in", "before", 1) for name in inputs])
            counts["resume: changed after the last look"] += 1
        expect(right, f"resume: {what} {when}, exit 0: {said}")
    elif what in ("nothing", "touch", "copy"):
        expect(False, f"resume: {what} {when}: exit {code}, {err}")
    forget("a.talus", "a.talus.part")


def some_update(name):
    rows, cols = (dice.randrange(SIDE // 8, 2 * SIDE) for _ in range(2))
    row, col = dice.randrange(0, 3 * SIDE - rows), dice.randrange(0, 3 * SIDE - cols)
    by = dice.randrange(1, 900)
    part = GROUND[row:row + rows, col:col + cols]
    write(name, numpy.where(part == NODATA, NODATA, part + by).astype(numpy.int16), col, row)
    return row, col, rows, cols, by


def after(updates):
    heights = GROUND.copy()
    for row, col, rows, cols, by in updates:
        part = GROUND[row:row + rows, col:col + cols]
        own = part != NODATA
        heights[row:row + rows, col:col + cols][own] = part[own] + by
    return heights


found_right = {}  # by the database's bytes and the updates: what was looked at once need not be looked at again


def equals_some(database, allowed):
    said = "no database is right"
    digest = hashlib.sha256(Path(database).read_bytes()).digest() if os.path.exists(database) else None
    for updates in allowed:
        key = digest, tuple(updates)
        if key not in found_right:
            write("expected.tif", after(updates), 0, 0)
            found_right[key] = is_right(database, ["expected.tif"])
        right, said = found_right[key]
        if right:
            return True, said
    return False, said


def updates_that_meet():
    shutil.copy("base.talus", "a.talus")
    names = [f"u{i}.tif" for i in range(dice.choice([2, 2, 3]))]
    updates = [some_update(name) for name in names]
    processes = []
    for name in names:
        processes.append(start("ingest", "--update", name, "a.talus", "--threads", 1))
        time.sleep(dice.uniform(0, 0.4))
    errs = [p.communicate()[1] for p in processes]
    codes = [p.returncode for p in processes]
    done = [u for u, code in zip(updates, codes) if code == 0]
    counts[f"meet: {len(done)} of {len(names)} exit 0"] += 1
    expect(done and all(code in (0, 1, 2) for code in codes), f"meet: exits {codes}: {errs}")
    right, said = equals_some("a.talus", itertools.permutations(done))
    expect(right, f"meet: exits {codes}: {said}")
    expect(not os.path.exists("a.talus.part"), "meet: a .part is left")
    forget("a.talus", "a.talus.part")


def killed_updates():
    found_right.clear()
    shutil.copy("base.talus", "a.talus")
    update = some_update("u0.tif")
    killed_somewhere(update_seconds, ["ingest", "--update", "u0.tif", "a.talus", "--threads", 1], signal.SIGKILL)
    right, said = equals_some("a.talus", [[], [update]])
    expect(right, f"kill: the database itself: {said}")
    is_updated = equals_some("a.talus", [[update]])[0] and not equals_some("a.talus", [[]])[0]
    has_part = os.path.exists("a.talus.part")
    counts[f"kill: {'updated' if is_updated else 'as it was'}, {'a' if has_part else 'no'} .part left"] += 1
    base = [update] if is_updated else []
    for command, allowed in [
            (["info", "a.talus"], [base]), (["query", "a.talus", "--tolerance", "5", "-o", "q.ply"], [base]),
            (["compact", "a.talus"], [base]),
            (["ingest", "--overwrite", "--resume", "base.tif", "a.talus"], [[]]),
            (["ingest", "--resume", "base.tif", "a.talus"], [base]),
            (["ingest", "--overwrite", "base.tif", "a.talus"], [[]]),
            (["ingest", "--update", "--resume", "u0.tif", "a.talus"], [[update]]),
            (["ingest", "--update", "u0.tif", "a.talus"], [[update]])]:
        for name in ("a.talus", "a.talus.part"):
            forget("x" + name)
            if os.path.exists(name):
                shutil.copy(name, "x" + name)
        command = ["x" + word if word == "a.talus" else word for word in command]
        code, _, err = run(*command)
        counts[f"kill: then {' '.join(command)}: exit {code}"] += 1
        expect(code in (0, 1, 2, 3), f"kill: {command}: exit {code}, {err}")
        right, said = equals_some("xa.talus", allowed if code == 0 else [base])
        expect(right, f"kill: {command}, exit {code}: {said}")
    forget("a.talus", "a.talus.part", "xa.talus", "xa.talus.part")


def damaged_part():
    for _ in range(10):
        forget("a.talus", "a.talus.part")
        killed_somewhere(base_seconds, ["ingest", "base.tif", "a.talus", "--threads", 1, "--memory", "300MiB"], signal.SIGINT)
        if os.path.exists("a.talus.part"):
            break
    if not os.path.exists("a.talus.part"):
        counts["damage: no .part to damage"] += 1
        forget("a.talus")
        return
    part = bytearray(Path("a.talus.part").read_bytes())
    pages = max(1, len(part) // 4096)
    what = dice.choice(["bit", "zeroed page", "swapped pages", "cut", "torn"])
    at, other = (4096 * dice.randrange(pages) for _ in range(2))
    if what == "bit" and part:
        part[dice.randrange(len(part))] ^= 1 << dice.randrange(8)
    elif what == "zeroed page":
        part[at:at + 4096] = bytes(len(part[at:at + 4096]))
    elif what == "swapped pages":
        part[at:at + 4096], part[other:other + 4096] = part[other:other + 4096], part[at:at + 4096]
    elif what == "cut" and part:
        del part[dice.randrange(len(part)):]
    elif what == "torn":
        part[at + 512:at + 4096] = os.urandom(len(part[at + 512:at + 4096]))
    Path("a.talus.part").write_bytes(part)
    code, _, err = run("ingest", "base.tif", "a.talus", "--resume")
    counts[f"damage: {what}: exit {code}"] += 1
    expect(code in (0, 3), f"damage: {what}: exit {code}, {err}")
    if code == 0:
        right, said = is_right("a.talus", ["base.tif"])
        expect(right, f"damage: {what}, exit 0: {said}")
    forget("a.talus", "a.talus.part")


write("base.tif", GROUND, 0, 0)
base_seconds = seconds_of("ingest", "base.tif", "base.talus", "--threads", "1", "--memory", "300MiB")
some_update("u0.tif")
shutil.copy("base.talus", "a.talus")
update_seconds = seconds_of("ingest", "--update", "u0.tif", "a.talus", "--threads", "1")
for kind in (resume_after_changes, updates_that_meet, killed_updates, damaged_part):
    if KINDS and kind.__name__ not in KINDS:
        continue
    for done in range(1, RUNS + 1):
        kind()
        if done % 10 == 0 and done < RUNS:
            print(f"{kind.__name__}: {done} of {RUNS} runs, {len(wrongs)} wrong so far", flush=True)
    print(f"{kind.__name__}: {RUNS} runs, {len(wrongs)} wrong so far", flush=True)
for what, count in sorted(counts.items()):
    print(f"{count:6}  {what}")
print(f"seed {SEED}: {len(wrongs)} wrong")
if wrongs:
    print(f"what was wrong is beside {work}")
os.chdir("/")
shutil.rmtree(work)
sys.exit(1 if wrongs else 0)
