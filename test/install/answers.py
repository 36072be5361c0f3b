#!/usr/bin/env python3
"""What README's commands answer, in the folder where docs.sh ran them: answers.py FOLDER README."""
import json
import pathlib
import re
import sys

folder, readme = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).read_text()
faults = []


def summary(run):
    return json.loads((folder / run / "summary.json").read_text())


def expect(right, what):
    print(("holds: " if right else "WRONG: ") + what)
    if not right:
        faults.append(what)


TABLE_2 = {"k_p": 50, "k_d": 1, "k_sea": 65, "c_sea": 1.6, "i_motor": 0.085}  # made the shipped trials
fit = summary("identify")
expect(fit["converged"] and fit["trusted"], "identify: converged, every constant trusted")
for name, truth in TABLE_2.items():
    c = fit["parameters"][name]
    off = (c["value"] - truth) / c["std"]
    expect(abs(off) < 3.5 and c["std"] < 0.05 * truth, f"identify: {name} {c['value']:.5g}, {off:+.1f} of its errors from {truth}")

for trial in summary("predict")["trials"]:
    expect(0.8 < trial["rms"] / trial["noise"] < 1.25, f"predict: rms {trial['rms']:.3g} rad, noise {trial['noise']:.3g}")

plan = summary("optimize")
value, held = plan["robust"]["promised"], plan["scatter"]["held"]["cvar90"]
expect(value < 0.6 * held, f"optimize --robust: worst tenth {value:.1f} promised, {held:.1f} held")
fresh = plan["robust"]["fresh"]["cvar90"]
expect(abs(fresh / value - 1) < 0.03, f"optimize --robust: {fresh:.1f} over fresh drops")
played = summary("simulate")["peak_acceleration"]
expect(abs(played / plan["peak_acceleration"] - 1) < 1e-6, f"simulate: the plan's peak again, {played:.2f}")

falling = summary("falling")
value, held = falling["tolerant_peak"], falling["hold"].get("tolerant_peak", falling["hold"]["peak_acceleration"])
expect(value < 0.9 * held, f"already falling: tolerant peak {value:.1f}, {held:.1f} held")

for run in ("optimize", "simulate", "falling"):
    ratings, warnings = summary(run)["ratings"], " ".join(summary(run)["warnings"])
    expect(not ratings["unknown"], f"{run}: the motor's ratings are known: {ratings['speed_max']} rad/s, {ratings['motor_torque_max']} Nm")
    beyond = max(ratings["peak_reference_rate"], ratings["motor_speed"]) > ratings["speed_max"]
    expect(beyond == ("could not follow" in warnings), f"{run}: {'breaks them and says so' if beyond else 'keeps them'}")

# The table of results, to the digits that it prints; a row for each run table_N.
commands = re.findall(r"^\| .*\| `ukemi ([^`]*)`", readme, re.M)
expect(len(commands) == 5, "the table has five commands")
for number, command in enumerate(commands, 1):
    printed = re.search(r"\| (\d+\.\d+)[^|]*\| `ukemi " + re.escape(command), readme).group(1)
    if command.startswith("bench"):
        continue  # its time budget makes it the machine's
    s = summary(f"table_{number}")
    got = s["tolerant_peak"] if "tolerant" in command else s["peak_acceleration"]
    expect(f"{got:.{len(printed.split('.')[1])}f}" == printed, f"table: {command}: {got:.4f}, README {printed}")

sys.exit(f"{len(faults)} of README's answers are not what README says" if faults else 0)
