#!/usr/bin/env python3
"""The fit of the eight shipped trials as SciPy users write it, for comparison with test/bench/identify.cpp.

    identify_scipy.py DATASETS [finite]

least_squares (trf) from a start 20 % off; the rig and its sensitivities by solve_ivp (DOP853, cut where the hit starts and ends). With
`finite` the Jacobian by SciPy's default differences over one solve_ivp a trial at its default tolerances, as most scripts leave it.
Needs python3-scipy.
"""
import os
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

START = np.array([60, 1.2, 78, 1.9, 0.1])  # Table 2 and a fifth


def read_rig(path):
    rig = {}
    for line in open(path):
        key, _, value = line.split('#')[0].partition('=')
        if value.strip():
            rig[key.strip()] = value.strip()
    return rig


def read_trial(path):
    rows = [line for line in open(path) if not line.startswith('#')]
    names = rows[0].strip().split(',')
    values = np.array([[float(x) for x in row.split(',')] for row in rows[1:]])
    return {name: values[:, i] for i, name in enumerate(names)}


def field(t, y, u, trial, length, inertia, limit):
    """Value and, where y carries them (24 numbers), sensitivities by each constant."""
    k_p, k_d, k, c, motor = u
    force = np.interp(t, trial['t'], trial['force'])
    lever = length * force
    tau = k * (y[1] - y[0]) + c * (y[3] - y[2])
    free = abs(tau) < limit
    tau = min(max(tau, -limit), limit)
    dy = np.empty_like(y)
    dy[:4] = y[2], y[3], (tau + lever * np.cos(y[0])) / inertia, (-k_p * y[0] - k_d * y[2] - tau) / motor
    if len(y) > 4:
        s = y[4:].reshape(5, 4)
        d_tau = np.zeros(5)
        if free:
            d_tau = k * (s[:, 1] - s[:, 0]) + c * (s[:, 3] - s[:, 2])
            d_tau[2] += y[1] - y[0]
            d_tau[3] += y[3] - y[2]
        ds = np.empty((5, 4))
        ds[:, 0], ds[:, 1] = s[:, 2], s[:, 3]
        ds[:, 2] = (d_tau - lever * np.sin(y[0]) * s[:, 0]) / inertia
        ds[:, 3] = (-k_p * s[:, 0] - k_d * s[:, 2] - d_tau) / motor
        ds[0, 3] -= y[0] / motor
        ds[1, 3] -= y[2] / motor
        ds[4, 3] -= dy[3] / motor
        dy[4:] = ds.ravel()
    return dy


def main():
    root = sys.argv[1]
    finite = len(sys.argv) > 2
    rig = read_rig(os.path.join(root, 'rigs/paper.toml'))
    length, inertia, limit = (float(rig[k]) for k in ('length', 'inertia_joint', 'tau_max'))
    trials = [read_trial(os.path.join(root, f'impact/trial_{i}.csv')) for i in range(1, 9)]
    def roll(trial, u, size):
        args, t = (u, trial, length, inertia, limit), trial['t']
        if finite:
            return solve_ivp(field, (t[0], t[-1]), np.zeros(size), t_eval=t, args=args).y
        hit = np.flatnonzero(trial['force'])
        first, last = hit[0] - 1, hit[-1] + 1  # at rest before
        y = np.zeros((size, len(t)))
        for i, j, longest in ((first, last, 1e-3), (last, len(t) - 1, np.inf)):
            y[:, i:j + 1] = solve_ivp(field, (t[i], t[j]), y[:, i], method='DOP853', t_eval=t[i:j + 1], max_step=longest,
                                      rtol=1e-8, atol=1e-11, args=args).y
        return y

    def run(x, size):
        return [roll(trial, x * START, size) for trial in trials]

    def residuals(x):
        return np.concatenate([y[0] - trial['phi'] for y, trial in zip(run(x, 4), trials)])

    def jacobian(x):
        return np.concatenate([y[4:].reshape(5, 4, -1)[:, 0, :].T * START for y in run(x, 24)])

    before = time.process_time()
    fit = least_squares(residuals, np.ones(5), bounds=(1e-6, np.inf), x_scale='jac', xtol=1e-10, ftol=1e-10, gtol=1e-12,
                        jac='2-point' if finite else jacobian)
    spent = time.process_time() - before
    print(f'{"finite differences" if finite else "sensitivities"}: {spent:.2f} s, cost {2 * fit.cost:.15f}, '
          f'constants {fit.x * START}, {fit.nfev} evaluations, status {fit.status}: {fit.message}')


main()
