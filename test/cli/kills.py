#!/usr/bin/env python3
"""kills.py UKEMI DATASETS [KILLS]: every verb, killed at random moments over the results of an earlier run.

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
VERBS = {  # what is run, and what the earlier run did otherwise
    "identify": (["identify", *TRIALS, "--rig", RIG], ["--seed", "2"]),
    "predict": (["predict", *TRIALS, "--rig", RIG, "--actuator", TABLE2], ["--accuracy", "1e-8"]),
    "design": (["design", *TRIALS, "--rig", RIG, "--actuator", TABLE2, "--check", "0"], ["--hits", "1"]),
    "simulate": (["simulate", *LANDING, "--hold", "-45"], ["--seed", "2"]),
    "optimize": (["optimize", *LANDING, "--evaluations", "300"], ["--seed", "2"]),
    "map": (["map", *LANDING, "--cells", "6"], ["--seed", "2"]),
    "risk": (["risk", *LANDING, "--hold", "-45", "--samples", "256"], ["--seed", "2"]),
    "compare": (["compare", "--nominal", TABLE2, "--identified", TABLE2, "--trials", *TRIALS, "--rig", RIG],
                ["--seed", "2"]),
    "atlas": (["atlas", *LANDING, "--height", "0.3:0.6:2", "--evaluations", "200"], None),
}


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
        text = re.sub(r"<section class=\"provenance\">.*?</section>|\"[a-z_]*time_s\": [-0-9.e]+|<!--.*?-->", "", text, flags=re.S)
        out[str(path.relative_to(folder))] = text
    return out


def differences(a, b):
    return sorted(name for name in a.keys() | b.keys() if a.get(name) != b.get(name))


def try_verb(name, command, other, work):
    reference, earlier, folder = work / "reference", work / "earlier", work / "out"
    began = time.monotonic()
    subprocess.run(ukemi(command, reference), check=True, stdout=subprocess.DEVNULL)
    length = time.monotonic() - began
    if other is not None:
        subprocess.run(ukemi(command + other, earlier), check=True, stdout=subprocess.DEVNULL)
    whole = {"new": contents(reference), "earlier": contents(earlier) if other is not None else {}}
    found = {"new": 0, "earlier": 0, "under way": 0}
    for k in range(KILLS):
        shutil.rmtree(folder, ignore_errors=True)
        if other is not None:
            shutil.copytree(earlier, folder)
        process = subprocess.Popen(ukemi(command, folder), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(random.uniform(0, 1.1 * length))
        process.send_signal(signal.SIGKILL)
        process.wait()
        left = contents(folder) if folder.exists() else {}
        state = next((s for s, files in whole.items() if not differences(left, files)), "under way")
        found[state] += 1
        if state == "under way" and name != "atlas":  # it alone goes on where it was
            sys.exit(f"{name}: kill {k} left neither run: {sorted(left)}; differ: {differences(left, whole['new'])}")
        if k % 10 == 0 or state == "under way":
            subprocess.run(ukemi(command, folder), check=True, stdout=subprocess.DEVNULL)
            if wrong := differences(contents(folder), whole["new"]):
                sys.exit(f"{name}: after kill {k} the next run differs: {wrong}")
            if beside := [p.name for p in folder.parent.iterdir() if p not in (reference, earlier, folder)]:
                sys.exit(f"{name}: after kill {k} the next run left {beside} beside its folder")
    print(f"{name}: {KILLS} kills within {length:.2f} s: {found['earlier']} found the earlier run, {found['new']} the new, "
          f"{found['under way']} a run that goes on", flush=True)


random.seed(1)
for name, (command, other) in VERBS.items():
    with tempfile.TemporaryDirectory() as work:
        try_verb(name, command, other, pathlib.Path(work))
