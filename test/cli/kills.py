#!/usr/bin/env python3
"""kills.py UKEMI DATASETS [KILLS [VERB...]]: every verb, killed at random moments over the results of an earlier run.

Whatever the moment, the folder holds one whole run, the earlier one or the new; and the next run ends as if nothing had
been: the same files, byte for byte but for where they come from, and nothing beside them.
"""
import json
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PROGRAM, DATA = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
KILLS = int(sys.argv[3]) if len(sys.argv) > 3 else 3
RIG, SCENE, TABLE2 = DATA / "rigs/paper.toml", DATA / "scenes/paper.toml", DATA / "actuators/table2.toml"
TRIALS = [DATA / f"impact/trial_{i}.csv" for i in (1, 2)]
LANDING = [SCENE, "--actuator", TABLE2]
SEED = ["--seed", "2"]
VERBS = {  # what is run, and by what the earlier run differed
    "identify": (["identify", *TRIALS, "--rig", RIG], ["--free", "k_p,k_d,k_sea,c_sea", "--start", TABLE2]),
    "predict": (["predict", *TRIALS, "--rig", RIG, "--actuator", TABLE2], [DATA / "impact/trial_3.csv"]),
    "design": (["design", *TRIALS, "--rig", RIG, "--actuator", TABLE2, "--check", "0"], ["--hits", "1"]),
    "simulate": (["simulate", *LANDING, "--hold", "-45"], ["--accuracy", "1e-5"]),
    "optimize": (["optimize", *LANDING, "--evaluations", "300"], SEED),
    "map": (["map", *LANDING, "--grid", "8", "8", "4"], ["--polish", "2"]),
    "risk": (["risk", *LANDING, "--hold", "-45", "--samples", "256"], SEED),
    "compare": (["compare", "--nominal", TABLE2, "--identified", TABLE2, "--trials", *TRIALS, "--rig", RIG],
                ["--trials", DATA / "impact/trial_3.csv"]),
    "ratings": (["ratings", *LANDING, "--motor-speed", "2:3:2", "--evaluations", "500"], SEED),
    "calibrate": (["calibrate", DATA / "drops/drop_1.csv", "--scene", DATA / "drops/first_guess.toml", "--actuator", TABLE2,
                   "--motion", DATA / "drops/hold.toml"], ["--height-of", "drop_1=0.3"]),
    "atlas": (["atlas", *LANDING, "--height", "0.3:0.6:4", "--speed", "0:1:3", "--pitch-deg", "-20:20:3", "--evaluations",
               "300", "--threads", "1"], None),
    "trade": (["trade", DATA / "scenes/hopper.toml", "--vary", "drive.knee.k_p=20:100:4", "--evaluations", "800"], SEED),
}


GOES_ON = {"atlas": ("atlas.csv", "atlas.bin"), "trade": ("trade.csv",)}  # from where it was; what it ends with
SILENT = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def ukemi(arguments, folder):
    return [PROGRAM, *map(str, arguments), "-o", str(folder), "--quiet"]


def contents(folder):
    """The files of a folder, without what tells one run of the same command from another."""
    out = {}
    for path in sorted(folder.rglob("*")):
        if path.is_dir():
            continue
        text = path.read_bytes().decode("latin-1")
        if path.name == "summary.json":
            summary = json.loads(text)
            summary.pop("provenance"), summary.pop("time_s", None)
            text = json.dumps(summary)
        text = "\n".join(line for line in text.split("\n") if not line.startswith("#"))
        if path.suffix == ".csv":
            rows = [row.split(",") for row in text.split("\n")]
            text = "\n".join(",".join(c for name, c in zip(rows[0], row) if "time_s" not in name) for row in rows)
        text = re.sub(r"<section class=\"provenance\">.*?</section>|\"[a-z_]*time_s\": [-0-9.e]+|<!--.*?-->|\[provenance\].*", "", text, flags=re.S)
        out[str(path.relative_to(folder))] = text
    return out


def differences(a, b):
    return sorted(name for name in a.keys() | b.keys() if a.get(name) != b.get(name))


def result(name, folder):
    """What the next run must end with; a run that goes on tells how much was left to do."""
    files = contents(folder)
    return {f: files[f] for f in GOES_ON[name]} if name in GOES_ON else files


def try_verb(name, command, other, work):
    reference, earlier, folder = work / "reference", work / "earlier", work / "out"
    began = time.monotonic()
    subprocess.run(ukemi(command, reference), check=True, **SILENT)
    length = time.monotonic() - began
    if other is not None:
        subprocess.run(ukemi(command + other, earlier), check=True, **SILENT)
    whole = {"new": contents(reference), "earlier": contents(earlier) if other is not None else {}}
    if other is not None and not differences(whole["new"], whole["earlier"]):
        sys.exit(f"{name}: the earlier run is the new one: nothing would be tested")
    found = {"new": 0, "earlier": 0, "under way": 0}
    for k in range(KILLS):
        shutil.rmtree(folder, ignore_errors=True)
        if other is not None:
            shutil.copytree(earlier, folder)
        process = subprocess.Popen(ukemi(command, folder), **SILENT)
        time.sleep(random.uniform(0, 1.1 * length))
        process.send_signal(signal.SIGKILL)
        process.wait()
        left = contents(folder) if folder.exists() else {}
        state = next((s for s, files in whole.items() if not differences(left, files)), "under way")
        found[state] += 1
        if state == "under way" and name not in GOES_ON:
            sys.exit(f"{name}: kill {k} left neither run: {sorted(left)}; differ: {differences(left, whole['new'])}")
        if k % 10 == 0 or k == KILLS - 1 or state == "under way":
            subprocess.run(ukemi(command, folder), check=True, **SILENT)
            if wrong := differences(result(name, folder), result(name, reference)):
                sys.exit(f"{name}: after kill {k} the next run differs: {wrong}")
            if beside := [p.name for p in folder.parent.iterdir() if p not in (reference, earlier, folder)]:
                sys.exit(f"{name}: after kill {k} the next run left {beside} beside its folder")
    print(f"{name}: {KILLS} kills within {length:.2f} s: {found['earlier']} found the earlier run, {found['new']} the new, "
          f"{found['under way']} a run that goes on", flush=True)


random.seed(1)
for name, (command, other) in VERBS.items():
    if sys.argv[4:] and name not in sys.argv[4:]:
        continue
    with tempfile.TemporaryDirectory() as work:
        try_verb(name, command, other, pathlib.Path(work))
