"""From impact logs to a landing, as a notebook would have it: each figure is an SVG that a notebook shows by itself.

    PYTHONPATH=build/release python3 tools/examples/landing.py [FOLDER]
"""
import pathlib
import sys

import numpy as np

import ukemi

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")

# %% The actuator's constants, from two impact tests.
rig = ukemi.read_rig(ukemi.dataset("rigs/paper.toml"))
trials = [ukemi.read_trial(ukemi.dataset(f"impact/trial_{i}.csv")) for i in (1, 2)]
fit = ukemi.identify(trials, rig)
for estimate in fit.parameters.values():
    print(estimate, estimate.verdict)
fit.figure().save(str(folder / "fit.svg"))

# %% The softest landing with them.
scene = ukemi.read_scene(ukemi.dataset("scenes/paper.toml"))
best = ukemi.optimize(scene, fit.actuator, objective="tolerant", evaluations=1000)
print(best, f"held: {best.held_peak:.1f} m/s^2")
best.figure().save(str(folder / "landing.svg"))

# %% Its trajectory is NumPy arrays.
landing = ukemi.simulate(scene, fit.actuator, best.motion)
knee = np.degrees(landing.phi_1)
print(f"the knee turns from {knee[0]:.0f} to {knee[-1]:.0f} deg, at most by {abs(landing.dphi_1).max():.1f} rad/s")
