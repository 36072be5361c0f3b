#!/usr/bin/env python3
"""Makes the README's pictures of reports: screens.py PROGRAM, from the repository. Each is the first screen of a report in Chromium."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / 'test' / 'report'))
import browser  # noqa: E402

SEA = ['--actuator', 'datasets/actuators/table2.toml']
SCREENS = {'identify': sorted(map(str, pathlib.Path('datasets/impact').glob('trial_*.csv'))) + ['--rig', 'datasets/rigs/paper.toml'],
           'optimize': ['datasets/scenes/paper.toml', *SEA, '--robust', 'cvar'],
           'compare': ['--nominal', 'datasets/actuators/x8-9_nominal.toml', '--identified', SEA[1], '--scene', 'datasets/scenes/paper.toml']}
WIDTH, HEIGHT = 900, 860  # [px]


def main(program):
    page = browser.Browser(shutil.which('chromium'))
    page.ask('Emulation.setDeviceMetricsOverride', width=WIDTH, height=HEIGHT, deviceScaleFactor=1, mobile=False)
    for verb, arguments in SCREENS.items():
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([program, verb, *arguments, '--quiet', '-o', folder], check=True, stdout=subprocess.DEVNULL)
            page.open(folder + '/report.html')
            time.sleep(1)  # the animation has drawn itself
            page.picture(f'tools/docs/report_{verb}.png', HEIGHT)
    page.close()


if __name__ == '__main__':
    main(*sys.argv[1:])
