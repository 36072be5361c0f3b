#!/usr/bin/env python3
"""Is what `ukemi identify` calls trusted right, where the rig or its drive has an effect that the rig file does not tell?

    trust_table.py UKEMI [--rows issue|all|NAME,...] [--draws 20] [--steps 4] [--keep FOLDER] [--check]

A row is an effect (`ROWS`); a draw is one actuator with eight hits, simulated apart from the library (rig_simulator.py). The
logs are fitted with the program's defaults and what the rig file says; then each advice of its warnings is followed as a user would, `--nuisance` by `--nuisance`, and the answers are held against the
truth at every step. Printed, a line for each row and step: fits, fits with a trusted constant, the largest |z| of a trusted
constant (z = (value - truth) / std), how many trusted ones are beyond 4, the largest error of them in per cent, the advice.

Exit code 1 where a trusted constant is more than 4 of its errors off, or where a row without any effect (`clean`) is not trusted.
`--check` holds the simulator against `ukemi predict` and against half its step instead.
Needs numpy. Angles in rad, SI units.
"""
import argparse
import collections
import concurrent.futures
import dataclasses
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

from rig_simulator import CONSTANTS, INERTIA, LENGTH, SOFT, Row, draws_of, step_of

EXACT = '[errors]\nexact = true'
CLEAN = 'feedback = "output"\n' + EXACT
ROWS = {
    # of the issue
    'delay_1ms': Row(delay=1e-3),
    'delay_2ms': Row(delay=2e-3),
    'filter_5ms': Row(velocity_filter=5e-3),
    'motor_feedback': Row(motor_feedback=True, rig=''),
    'link_5_percent': Row(inertia=1.05),
    'softening': Row(softening=0.3),
    'ripple': Row(ripple=(0.5e-3, 32)),
    'friction_soft': Row(friction=0.3, hits=SOFT),
    'viscous_0.01': Row(viscous=0.01),
    'viscous_0.05': Row(viscous=0.05),
    'force_gain_1_percent': Row(force_gain=1.01, alternate=True),
    'encoder_gain_1_percent': Row(encoder_gain=1.01, alternate=True),
    'clean': Row(rig=CLEAN),
    # more
    'clean_unstated': Row(),
    'clean_feedback_unstated': Row(rig=''),
    'digital_1kHz': Row(period=1e-3),
    'link_and_force': Row(inertia=1.01, force_gain=0.99, length=1.005, alternate=True),
    'delay_and_filter': Row(delay=1e-3, velocity_filter=2e-3),
    'delay_and_viscous': Row(delay=1e-3, viscous=0.05),
    'filter_and_friction': Row(velocity_filter=3e-3, friction=0.1),
    'motor_feedback_and_delay': Row(motor_feedback=True, delay=1e-3, rig=''),
    'motor_feedback_and_friction': Row(motor_feedback=True, friction=0.2, rig=''),
    'eccentric_encoder': Row(ripple=(5e-3, 1)),
    'limit_untold': Row(tau_max=0.8, hits=(0.05, 0.25)),
    'friction_softer': Row(friction=0.3, hits=(0.008, 0.04)),
    'drive_limit_untold': Row(drive_max=0.6, hits=(0.05, 0.25)),
    'backlash': Row(backlash=2e-3),
    'force_filter_1ms': Row(force_filter=1e-3),
    'delay_1ms_stated': Row(delay=1e-3, rig=CLEAN + '\n[drive]\ncontrol_delay = 0.001'),
    'filter_5ms_stated': Row(velocity_filter=5e-3, rig=CLEAN + '\n[drive]\nvelocity_filter = 0.005'),
    'output_viscous_0.05': Row(output_viscous=0.05),
    'time_shift_1ms': Row(time_shift=1e-3),
    'smooth_force': Row(smooth=True, rig=CLEAN),
    'encoder_14_bit': Row(noise=0, quantum=2 * np.pi / 2**14, rig=CLEAN),
    'encoder_12_bit': Row(noise=0, quantum=2 * np.pi / 2**12, rig=CLEAN),
    'delay_1ms_1kHz': Row(delay=1e-3, rate=1000),
    'filter_5ms_soft': Row(velocity_filter=5e-3, hits=SOFT),
    'motor_feedback_soft': Row(motor_feedback=True, hits=SOFT, rig=''),
    'link_5_percent_soft': Row(inertia=1.05, hits=SOFT),
}
OF_ISSUE = list(ROWS)[:13]


def written(draw, folder, seed):
    """The rig file and the logs as a laboratory would have them; their paths."""
    row, random = draw.row, np.random.default_rng(seed)
    folder.mkdir(parents=True)
    rig = folder / 'rig.toml'
    rig.write_text(f'[rig]\nlength = {LENGTH}\ninertia_joint = {INERTIA}\n{row.rig}\n')
    logs = []
    height, periods = row.ripple
    phase = random.uniform(0, 2 * np.pi)
    for m, phi in enumerate(draw.phi):
        angle = row.encoder_gain * phi + height * (np.sin(periods * phi + phase) - np.sin(phase))
        angle = angle + row.noise * random.normal(size=len(phi))
        if row.quantum:
            angle = row.quantum * np.round(angle / row.quantum)
        table = np.column_stack([draw.t, row.force_gain * draw.force[:, m], angle])
        logs.append(folder / f'hit_{m + 1}.csv')
        np.savetxt(logs[-1], table, '%.12g', ',', header='t,force,phi', comments='')
    return rig, logs


@dataclasses.dataclass
class Answer:
    step: int
    terms: tuple          # --nuisance so far
    code: int
    message: str          # of a refusal
    values: dict          # name -> (value, std, verdict)
    warnings: list
    advice: list          # further options, each a tuple of (option, value)


def advice_in(warnings, terms, starts):
    """What a reader of the warnings would try next: terms named after --nuisance, and --starts N."""
    out = []
    for text in warnings:
        for names in re.findall(r'--nuisance ([a-z_,]+[a-z_])', text):
            fresh = tuple(name for name in names.split(',') if name not in terms)
            if fresh:
                out.append(('--nuisance', fresh))
        out += [('--starts', int(n)) for n in re.findall(r'--starts (\d+)', text) if int(n) > starts]
    return list(dict.fromkeys(out))


def identify(program, rig, logs, step, terms, starts):
    options = ['--nuisance', ','.join(terms)] if terms else []
    options += ['--starts', str(starts)] if starts else []
    out = logs[0].parent / f'out_{"_".join(terms) or "plain"}_{starts}'
    command = [program, 'identify', *map(str, logs), '--rig', str(rig), '-o', str(out), '--json', '--no-report',
               '--threads', '1', *options]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if not run.stdout.startswith('{'):
        return Answer(step, terms, run.returncode, run.stderr.strip(), {}, [], [])
    summary = json.loads(run.stdout)
    values = {name: (e['value'], e['std'], e['verdict']) for name, e in summary['parameters'].items()}
    return Answer(step, terms, run.returncode, '', values, summary['warnings'],
                  advice_in(summary['warnings'], terms, starts))


def followed(program, draw, folder, seed, steps):
    """The answers from the plain fit on, each advice taken until there is none, breadth first."""
    rig, logs = written(draw, folder, seed)
    answers, todo, seen = [], [(0, (), 0)], set()
    while todo:
        step, terms, starts = todo.pop(0)
        key = frozenset(terms), starts
        if key in seen:
            continue
        seen.add(key)
        answers.append(identify(program, rig, logs, step, terms, starts))
        if step < steps:
            for option, value in answers[-1].advice[:3]:
                more, many = (terms + value, starts) if option == '--nuisance' else (terms, value)
                todo.append((step + 1, more, many))
    return answers


def judged(draw, answer):
    """(constant, z, relative error) of each constant that is trusted."""
    out = []
    for name, true in zip(CONSTANTS, draw.truth):
        value, std, verdict = answer.values.get(name, (0, None, ''))
        if verdict == 'trusted':
            out.append((name, (value - true) / std, value / true - 1))
    return out


def line_of(name, step, fits):
    """The table's line of a step, (draw, answer) each; and whether all that is trusted is right."""
    trusted = [judged(draw, answer) for draw, answer in fits]
    every = [t for of_fit in trusted for t in of_fit]
    beyond = [t for t in every if not abs(t[1]) <= 4]
    refused = [answer.message for _, answer in fits if answer.code == 2]
    advice = collections.Counter(f'{option[2:]} {",".join(value) if option == "--nuisance" else value}'
                                 for _, answer in fits for option, value in answer.advice)
    words = [f'{n} x {what}' for what, n in advice.most_common(5)] + [f'{len(refused)} refused: {m}' for m in refused[:1]]
    whole = sum(len(t) == len(CONSTANTS) for t in trusted)
    line = f'{name:28s} {step:4d} {len(fits):5d} {sum(map(bool, trusted)):7d} {whole:4d} '
    if every:
        constant, z, _ = max(every, key=lambda t: abs(t[1]))
        line += f'{abs(z):8.1f} {constant:8s}{len(beyond):4d}/{len(every):<4d} {100 * max(abs(t[2]) for t in every):7.1f}'
    else:
        line += f'{"-":>8s} {"":8s}   0/0    {"-":>7s}'
    return f'{line}  {"; ".join(words)}', not beyond and not refused and (name != 'clean' or step > 0 or whole == len(fits))


HEADER = (f'{"row":28s} step  fits trusted  all  worst z {"of":8s}beyond 4   off %  advice\n'
          '(trusted: fits with a trusted constant, and with all five; off: largest error of a trusted constant)')


def check(program, folder):
    """The simulator: against `ukemi predict`, and each row's against its own at half the step. Worst difference [rad]."""
    worst = 0
    for name, row in ROWS.items():
        coarse, fine = (draws_of(name, row, 2, h) for h in (step_of(row), step_of(row) / 2))
        halved = max(np.abs(a.phi - b.phi).max() for a, b in zip(coarse, fine))
        print(f'{name:28s} step halved: {halved:.1e} rad')
        worst = max(worst, halved)
    draw = draws_of('clean', ROWS['clean'], 1, 2.5e-4)[0]
    draw.row = dataclasses.replace(draw.row, noise=0, rig='')
    rig, logs = written(draw, folder / 'check', 1)
    actuator = folder / 'actuator.toml'
    keys = ''.join(f'{n} = {v!r}\n' for n, v in zip(CONSTANTS, draw.truth.tolist()))
    actuator.write_text(f'[actuator]\nname = "true"\n{keys}')
    command = [program, 'predict', *map(str, logs), '--rig', str(rig), '--actuator', str(actuator), '--force-curve', 'linear',
               '--json', '-o', str(folder / 'predict')]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    rms = json.loads(run.stdout)['rms']
    print(f'against predict: rms {rms:.1e} rad')
    return max(worst, rms)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('program')
    p.add_argument('--rows', default='issue', help='issue, all, or names')
    p.add_argument('--draws', type=int, default=20)
    p.add_argument('--steps', type=int, default=4, help='of advice that is followed')
    p.add_argument('--jobs', type=int, default=1)
    p.add_argument('--keep', help='folder for the logs and results')
    p.add_argument('--check', action='store_true')
    a = p.parse_args()
    names = OF_ISSUE if a.rows == 'issue' else list(ROWS) if a.rows == 'all' else a.rows.split(',')
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(a.keep or scratch)
        if a.check:
            return int(check(a.program, folder) > 1e-6)
        print(HEADER, flush=True)
        right = True
        for name in names:
            draws = draws_of(name, ROWS[name], a.draws, step_of(ROWS[name]))
            with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
                answers = list(pool.map(lambda d: followed(a.program, draws[d], folder / f'{name}_{d}', d, a.steps),
                                        range(a.draws)))
            for step in range(1 + max(a.step for of_draw in answers for a in of_draw)):
                line, fine = line_of(name, step, [(d, a) for d, of_draw in zip(draws, answers) for a in of_draw if a.step == step])
                right &= fine
                print(line, flush=True)
        print('right' if right else 'WRONG: see "beyond 4", and whether `clean` is trusted')
        return int(not right)


if __name__ == '__main__':
    sys.exit(main())
