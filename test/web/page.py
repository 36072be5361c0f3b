#!/usr/bin/env python3
"""The page of tools/web in headless Chromium, against the program: page.py PROGRAM DATASETS PAGE [PICTURES].

Its peaks are those of `ukemi simulate` for the files that it saves, a slider that is moved changes the landing, a second
finds a softer motion, and what is wrong with a file is told with its place. With a folder PICTURES the page is kept as
PNG. Skips (code 77) where the page is not built, or Emscripten or Chromium is missing."""
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'report'))
from browser import OVERFLOW, Browser  # noqa: E402

LARGEST = 3e6  # bytes of the page
SAME = 1e-9  # relative, of two peaks
faults = []


def check(right, what):
    if not right:
        faults.append(what)


class Page:
    """What a user does to the page, and sees of it."""

    def __init__(self, chromium, path, downloads):
        self.browser, self.path, self.downloads = Browser(chromium), path, downloads
        self.browser.ask('Browser.setDownloadBehavior', behavior='allow', downloadPath=downloads)

    def open(self, width=1280, scheme='light'):
        self.browser.ask('Emulation.setDeviceMetricsOverride', width=width, height=900, deviceScaleFactor=1, mobile=False)
        self.browser.ask('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': scheme}])
        self.browser.open(self.path)
        self.wait()

    def wait(self):
        """Until what was asked for is shown."""
        self.browser.value('new Promise(done => setTimeout(done, 50))')
        end = time.time() + 60
        while self.browser.value('document.body.dataset.state') != 'ready':
            if time.time() > end:
                raise TimeoutError('the page does not answer: ' + self.error())
            time.sleep(.02)

    def text(self, name):
        return self.browser.value(f"document.getElementById('{name}').textContent")

    def error(self):
        return self.text('error')

    def peak(self):
        return float(self.browser.value("document.getElementById('sentence').dataset.peak"))

    def held(self):
        return float(self.browser.value("document.getElementById('sentence').dataset.held"))

    def choose(self, scene):
        self.browser.value(f"(s => {{ s.value = '{scene}.toml'; s.dispatchEvent(new Event('change')); }})(document.getElementById('scenes'))")
        self.wait()

    def click(self, name):
        self.browser.value(f"document.getElementById('{name}').click()")
        self.wait()

    def sliders(self):
        return self.browser.value("[...document.querySelectorAll('#numbers input')].map(i => i.name)")

    def turn(self, name, part):
        self.browser.value(f"(i => {{ i.value = {part}; i.dispatchEvent(new Event('input')); }})(document.querySelector('#numbers input[name=\"{name}\"]'))")
        self.wait()

    def press(self, name, part):
        """The mouse on a part of a slider's way."""
        x, y = self.browser.value(f"""(i => {{ i.scrollIntoView({{block: 'center'}}); const b = i.getBoundingClientRect();
            return [b.left + {part} * b.width, b.top + b.height / 2]; }})(document.querySelector('#numbers input[name="{name}"]'))""")
        for kind in ('mousePressed', 'mouseReleased'):
            self.browser.ask('Input.dispatchMouseEvent', type=kind, x=x, y=y, button='left', clickCount=1)
        self.wait()

    def save(self, button, name):
        """A file as it comes out of the page."""
        path = os.path.join(self.downloads, name)
        if os.path.exists(path):
            os.remove(path)
        self.browser.value(f"document.getElementById('{button}').click()")
        end = time.time() + 30
        while not (os.path.exists(path) and os.path.getsize(path)):
            if time.time() > end:
                raise TimeoutError(name + ' was not saved')
            time.sleep(.05)
        return path

    def give(self, *paths):
        """Files into the page's dialog."""
        root = self.browser.ask('DOM.getDocument')['root']['nodeId']
        node = self.browser.ask('DOM.querySelector', nodeId=root, selector='#open')['nodeId']
        self.browser.ask('DOM.setFileInputFiles', nodeId=node, files=list(paths))
        self.wait()

    def complaints(self):
        """Errors, and requests for anything but the page itself."""
        out = []
        for e in self.browser.events:
            method, p = e.get('method'), e.get('params', {})
            if method in ('Runtime.exceptionThrown', 'Log.entryAdded', 'Runtime.consoleAPICalled'):
                out.append(json.dumps(p)[:300])
            if method == 'Network.requestWillBeSent' and p['request']['url'] != 'file://' + self.path \
                    and not p['request']['url'].startswith('blob:'):
                out.append('request: ' + p['request']['url'][:200])
        return out


class Program:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def peak(self, *arguments):
        out = os.path.join(self.folder, 'simulate')
        shutil.rmtree(out, ignore_errors=True)
        done = subprocess.run([self.program, 'simulate', *arguments, '-o', out, '--quiet', '--no-report'], capture_output=True, text=True)
        if done.returncode not in (0, 1):
            check(False, ' '.join(arguments) + ': ' + done.stderr[-400:])
            return float('nan')
        with open(os.path.join(out, 'summary.json'), encoding='utf-8') as f:
            return json.load(f)['peak_acceleration']


def same_peaks(page, program, data):
    """Held as the shipped file says, then motions and drops at random places of the sliders, by the files that are saved."""
    places, table = random.Random(1), ['--actuator', data + '/actuators/table2.toml']
    for scene in ('paper', 'hopper', 'foot', 'three_links'):
        page.choose(scene)
        check(not page.error(), f'{scene}: {page.error()}')
        more, hold = (table, ['--hold', '-45']) if scene == 'paper' else ([], [])
        compare(scene + ', held', page.peak(), program.peak(f'{data}/scenes/{scene}.toml', *more, *hold))
        for n in range(3):
            for name in page.sliders():
                if n == 2 or not name.startswith(('drop.', 'floor.')):
                    page.turn(name, places.uniform(.2, .8))
            saved, motion = page.save('save', scene + '.toml'), page.save('save-motion', 'motion.toml')
            compare(f'{scene}, motion {n + 1}', page.peak(), program.peak(saved, *more, '--motion', motion))


def compare(what, page, program):
    different = abs(page - program) / program
    print(f'{what}: {page!r}, relative difference {different:.1e}')
    check(different <= SAME, f'{what}: the page has {page!r}, the program {program!r}')


def user(page):
    """A slider under the mouse, a plan in a second, holding again."""
    for scene in ('paper', 'hopper', 'foot', 'three_links'):
        page.choose(scene)
        held = page.peak()
        page.press('drop.height', .8)
        check(page.peak() != held, f'{scene}: from higher up the peak is the same, {held}')
        page.click('reset')
        check(page.peak() == held, f'{scene}: as in the file {page.peak()} where it was {held}')
        begin = time.time()
        page.click('plan')
        print(f'{scene}: a plan in {time.time() - begin:.2f} s: {page.text("sentence")}')
        check(page.peak() < .8 * held and page.held() == held, f'{scene}: planned {page.peak()}, held {held}, {page.held()}')
        check('softer' in page.text('sentence'), page.text('sentence'))
        stages = page.browser.value("document.querySelectorAll('.stage').length")
        check(stages == 2, f'{scene}: {stages} falls stand beside each other')
        page.click('hold')
        check(page.peak() == held, f'{scene}: held again {page.peak()} where it was {held}')
    before = page.browser.value("document.querySelector('#player polyline.link').getAttribute('points')")
    page.browser.value("(s => { s.value = 0; s.dispatchEvent(new Event('input')); })(document.querySelector('#player input[type=range]'))")
    page.browser.value("document.querySelector('#player button').click()")
    page.browser.value('new Promise(done => setTimeout(done, 400))')
    check(page.browser.value("document.querySelector('#player polyline.link').getAttribute('points')") != before, 'the fall does not play')


def files(page, program, data, folder):
    """Files that are opened: a whole scene, a robot alone, one that another is missing for, wrong ones."""
    def written(name, text):
        path = os.path.join(folder, name)
        with open(path, 'w', encoding='utf-8') as f:
            f.write(text)
        return path

    with open(data + '/scenes/hopper.toml', encoding='utf-8') as f:
        hopper = f.read()
    own = written('own.toml', hopper.replace('../robots/hopper.toml', 'leg.toml'))
    leg = os.path.join(folder, 'leg.toml')
    shutil.copy(data + '/robots/hopper.toml', leg)
    page.give(own)
    check('leg.toml is missing' in page.error(), 'a missing robot: ' + page.error())
    page.give(own, leg)
    compare('own.toml with leg.toml', page.peak(), program.peak(own))
    page.give(leg)
    check(page.text('command').startswith('ukemi simulate leg_drop.toml'), page.text('command'))
    compare('leg.toml alone', page.peak(), program.peak(page.save('save', 'leg_drop.toml')))
    page.give(data + '/scenes/tilted.toml', data + '/actuators/x8-9_nominal.toml')
    compare('tilted.toml', page.peak(), program.peak(data + '/scenes/tilted.toml', '--actuator', data + '/actuators/x8-9_nominal.toml', '--hold', '-45'))
    page.give(written('radians.toml', hopper.replace('hold_deg = -70', 'hold_deg = -1.22')), leg)
    check('-1.22: degrees, not radians' in page.text('doubts'), 'no doubt: ' + page.text('doubts') + page.error())
    page.give(own, leg)
    check(page.text('doubts') == '', 'a doubt that stays: ' + page.text('doubts'))
    for name, text, place in (('number.toml', hopper.replace('height = 0.3', 'height = -1  '), 'number.toml:13:10: '),
                              ('key.toml', hopper.replace('[search]', '[serach]'), 'key.toml:16:2: '),
                              ('text.toml', hopper.replace('= 0.8', '= = 0.8'), 'text.toml:7:12: ')):
        page.give(written(name, text))
        check(page.error().startswith(place), f'{place} is not told: {page.error()}')


def look(page, pictures):
    for width in (1280, 390):
        for scheme in ('light', 'dark'):
            page.open(width, scheme)
            page.click('plan')
            check(page.browser.value(OVERFLOW) == '', f'{width} px, {scheme}: {page.browser.value(OVERFLOW)}')
            for fault in page.complaints():
                check(False, f'{width} px, {scheme}: {fault}')
            if pictures:
                page.browser.picture(f'{pictures}/page_{width}_{scheme}.png')


def main():
    program, data, path = sys.argv[1:4]
    pictures = sys.argv[4] if len(sys.argv) > 4 else ''
    chromium = shutil.which('chromium') or shutil.which('chromium-browser')
    for there, what in ((chromium, 'there is no chromium here'), (shutil.which('em++'), 'there is no em++ here (Debian: emscripten)'),
                        (os.path.exists(path), f'{path} is not built: cmake --preset web && cmake --build --preset web')):
        if not there:
            print('skipped: ' + what)
            return 77
    check(os.path.getsize(path) < LARGEST, f'{os.path.getsize(path)} bytes')
    print(f'{os.path.getsize(path)} bytes')
    if pictures:
        os.makedirs(pictures, exist_ok=True)
    folder = tempfile.mkdtemp()
    downloads = os.path.join(folder, 'downloads')
    os.makedirs(downloads)
    page = Page(chromium, path, downloads)
    try:
        look(page, pictures)
        page.open()
        same_peaks(page, Program(program, folder), data)
        user(page)
        files(page, Program(program, folder), data, folder)
        for fault in page.complaints():
            check(False, fault)
    finally:
        page.browser.close()
        shutil.rmtree(folder, ignore_errors=True)
    if faults and os.path.getmtime(path) < os.path.getmtime(program):
        faults.append('the page is older than the program: cmake --build --preset web')
    print('\n'.join(faults) if faults else 'the page is as it should be')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
