#!/usr/bin/env python3
"""Opens reports in headless Chromium and looks at them as a reader does: browser.py PROGRAM DATASETS [PICTURES].

Every report is opened at 1280 and 390 pixels, light and dark, and with script off. It must raise no error, ask for
nothing but itself, and run off at no side; where it holds an animation that must move, and its slider must show the time.
With a folder PICTURES the pages are kept as PNG. Skips (code 77) where there is no Chromium."""
import base64
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time

PATIENCE = 60  # [s] of one answer


class Browser:
    """Chromium's own protocol over two pipes, file descriptors 3 and 4 of the browser."""

    def __init__(self, program):
        self.home = tempfile.mkdtemp()
        to_read, self.write = os.pipe()
        self.read, to_write = os.pipe()

        def connect():
            os.dup2(to_read, 103), os.dup2(to_write, 104)
            os.dup2(103, 3), os.dup2(104, 4)

        self.process = subprocess.Popen(
            [program, '--headless', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--hide-scrollbars',
             '--remote-debugging-pipe', '--user-data-dir=' + self.home, 'about:blank'],
            close_fds=False, preexec_fn=connect, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read), os.close(to_write)
        self.number, self.buffer, self.events = 0, b'', []
        target = self.ask('Target.createTarget', url='about:blank')['targetId']
        self.session = None
        self.session = self.ask('Target.attachToTarget', targetId=target, flatten=True)['sessionId']
        for domain in ('Page', 'Runtime', 'Log', 'Network'):
            self.ask(domain + '.enable')

    def message(self):
        end = time.time() + PATIENCE
        while b'\0' not in self.buffer:
            if not select.select([self.read], [], [], max(0, end - time.time()))[0]:
                raise TimeoutError('the browser does not answer')
            part = os.read(self.read, 1 << 20)
            if not part:
                raise RuntimeError('the browser has gone')
            self.buffer += part
        text, self.buffer = self.buffer.split(b'\0', 1)
        return json.loads(text)

    def ask(self, method, **parameters):
        self.number += 1
        request = {'id': self.number, 'method': method, 'params': parameters}
        if getattr(self, 'session', None):
            request['sessionId'] = self.session
        os.write(self.write, json.dumps(request).encode() + b'\0')
        while True:
            answer = self.message()
            if answer.get('id') == self.number:
                if 'error' in answer:
                    raise RuntimeError(method + ': ' + answer['error']['message'])
                return answer['result']
            self.events.append(answer)

    def open(self, path):
        self.events = []
        self.ask('Page.navigate', url='file://' + path)
        while not any(e.get('method') == 'Page.loadEventFired' for e in self.events):
            self.events.append(self.message())

    def value(self, expression):
        answer = self.ask('Runtime.evaluate', expression=expression, returnByValue=True, awaitPromise=True)
        if 'exceptionDetails' in answer:
            raise RuntimeError(expression + ': ' + json.dumps(answer['exceptionDetails'])[:500])
        return answer['result'].get('value')

    def picture(self, path, most=12000):
        height = self.value('document.documentElement.scrollHeight')
        width = self.value('innerWidth')
        data = self.ask('Page.captureScreenshot', captureBeyondViewport=True,
                        clip={'x': 0, 'y': 0, 'width': width, 'height': min(height, most), 'scale': 1})['data']
        with open(path, 'wb') as f:
            f.write(base64.b64decode(data))

    def close(self):
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.home, ignore_errors=True)


faults = []


def check(right, report, what):
    if not right:
        faults.append(f'{report}: {what}')


def errors_and_requests(browser):
    out = []
    for e in browser.events:
        method, p = e.get('method'), e.get('params', {})
        if method == 'Runtime.exceptionThrown':
            out.append('error: ' + json.dumps(p)[:300])
        if method == 'Log.entryAdded' and p['entry']['level'] in ('error', 'warning'):
            out.append('log: ' + p['entry']['text'])
        if method == 'Runtime.consoleAPICalled':
            out.append('console: ' + p['type'])
        if method == 'Network.requestWillBeSent':
            url = p['request']['url']
            if not (url.startswith('file://') and url.endswith('/report.html')) and not url.startswith('data:'):
                out.append('request: ' + url)
    return out


OVERFLOW = """(() => {
  const wide = document.documentElement.scrollWidth - innerWidth;
  return wide > 0 ? 'wider than the window by ' + wide : '';
})()"""
# Texts of one figure whose boxes cover each other.
OVERLAP = """(() => {
  const out = [];
  for (const svg of document.querySelectorAll('figure svg')) {
    const texts = [...svg.querySelectorAll('text')].filter(t => t.textContent.trim())
      .map(t => [t.textContent.trim(), t.getBoundingClientRect()]);
    const frame = svg.getBoundingClientRect();
    texts.forEach(([a, p], i) => {
      if (p.left < frame.left - 1 || p.right > frame.right + 1 || p.top < frame.top - 1 || p.bottom > frame.bottom + 1)
        out.push(svg.closest('figure').id + ': "' + a + '" leaves its figure');
      for (const [b, q] of texts.slice(i + 1)) {
        const x = Math.min(p.right, q.right) - Math.max(p.left, q.left), y = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
        if (x > 1 && y > .35 * Math.min(p.height, q.height)) out.push(svg.closest('figure').id + ': "' + a + '" over "' + b + '"');
      }
    });
  }
  return out.join('; ');
})()"""


# The animation and its controls are seen at once.
STAGE = """(() => {
  const height = document.getElementById('player').getBoundingClientRect().height, stages = document.querySelectorAll('.stage').length;
  const rows = innerWidth < 700 ? stages : 1;
  return height > innerHeight * (rows > 1 ? 1.3 : .85) ? 'the animation is ' + height + ' px high' : '';
})()"""
# What is missing of the answer in the first screen: the sentence, the checklist (each line with a sign and a word).
FIRST_SCREEN = """(() => {
  const sentence = document.querySelector('.answer .sentence'), checks = [...document.querySelectorAll('.answer li')];
  if (!sentence || !sentence.textContent.trim()) return 'no sentence';
  if (checks.length < 2) return checks.length + ' checks';
  const out = [];
  for (const e of [sentence, ...checks]) {
    const box = e.getBoundingClientRect();
    if (box.height < 10 || box.top < 0 || box.bottom > innerHeight || box.right > innerWidth)
      out.push('outside the first screen: ' + e.textContent);
  }
  for (const c of checks)
    if (!/^[✓!✗?] .+: (yes|caution|no|not known)/.test(c.textContent)) out.push('no sign and word: ' + c.textContent);
  return out.join('; ');
})()"""


def look_at_animation(browser, report, summary):
    """The slider shows the stated time, playing moves the robot, the numbered peaks are those of the summary."""
    browser.value("""window.slide = t => { const s = document.querySelector('#player input[type=range]');
        s.value = t; s.dispatchEvent(new Event('input')); }""")
    robot = "document.querySelector('#player polyline.link').getAttribute('points')"
    time_shown = "document.querySelector('#player output').textContent"
    cursor = "document.querySelector('#figure-acceleration .cursor').getAttribute('x1')"
    browser.value('slide(0.1)')
    ghosts = "[...document.querySelectorAll('#player polyline.ghost')].map(g => g.getAttribute('points')).join(';')"
    drops = browser.value(ghosts)
    check((drops.count(';') == 9) == (report == 'robust'), report, f'ghosts: {drops[:200]}')
    before, at = browser.value(robot), float(browser.value(cursor))
    check(browser.value(time_shown) == '0.1000 s', report, 'the slider at 0.1 s shows ' + browser.value(time_shown))
    browser.value('slide(0.2)')
    check(browser.value(robot) != before, report, 'the slider does not move the robot')
    check(report != 'robust' or browser.value(ghosts) != drops, report, 'the slider does not move the ghosts')
    check(float(browser.value(cursor)) > at, report, 'the slider does not move the cursor of the figure')
    browser.value("document.querySelector('#player select').value = 1")
    browser.value("document.querySelector('#player button').click()")
    browser.value('new Promise(done => setTimeout(done, 400))')
    moved = float(browser.value(time_shown).split()[0])
    check(moved > 0.2, report, f'playing from 0.2 s stands at {moved} s')
    peaks = summary.get('peaks')
    for peak in peaks if isinstance(peaks, list) else []:
        browser.value(f"slide({peak['t']})")
        said = browser.value("document.querySelector('#player .said').textContent")
        shown = float(said.split()[1])
        check(abs(shown - peak['acceleration']) < .02 * peak['acceleration'] + .1, report, f"at peak {peak['n']} the robot has {shown}")
        check(f"contact {peak['contact']}: {peak['acceleration']:.1f} m/s²" in said, report, f"peak {peak['n']}: {said}")


# The figure's panel in the window, and what a reader sees of it.
PANEL = """(name => {
  const figure = document.getElementById('figure-' + name), svg = figure.querySelector('svg'), panel = JSON.parse(figure.dataset.panels)[0];
  svg.scrollIntoView({block: 'center'});
  const m = svg.getScreenCTM(), zoomed = svg.querySelector('.zoomed');
  const ticks = zoomed.style.display === 'none' ? [] : [...zoomed.querySelectorAll('text[text-anchor=middle]')]
    .map(t => Number(t.textContent)).filter(t => !isNaN(t));
  return {left: m.a * panel.left + m.e, right: m.a * panel.right + m.e, top: m.d * panel.top + m.f, bottom: m.d * panel.bottom + m.f,
          x: panel.x, ticks, read: figure.querySelector('.look output').textContent, scroll: scrollY};
})"""


class Reader:
    """What a reader does to a figure: real events of a mouse and keys, at parts of a panel's width."""

    def __init__(self, browser, figure):
        self.browser, self.figure = browser, figure

    def sees(self, figure=None):
        return self.browser.value(f"{PANEL}('{figure or self.figure}')")

    def mouse(self, kind, part, height=.5, **more):
        p = self.sees()
        self.browser.ask('Input.dispatchMouseEvent', type=kind, x=p['left'] + part * (p['right'] - p['left']),
                         y=p['top'] + height * (p['bottom'] - p['top']), **more)

    def click(self, part, count=1):
        for i in range(count):
            for kind in ('mousePressed', 'mouseReleased'):
                self.mouse(kind, part, button='left', clickCount=i + 1)

    def drag(self, begin, end, **more):
        self.mouse('mousePressed', begin, button='left', clickCount=1, **more)
        for part in (begin + (end - begin) / 2, end):
            self.mouse('mouseMoved', part, button='left', buttons=1, **more)
        self.mouse('mouseReleased', end, button='left', **more)

    def wheel(self, part, delta):
        self.mouse('mouseWheel', part, deltaX=0, deltaY=delta)

    def key(self, key, **more):
        text = {'text': key} if len(key) == 1 else {}
        for kind in ('keyDown', 'keyUp'):
            self.browser.ask('Input.dispatchKeyEvent', type=kind, key=key, **more, **(text if kind == 'keyDown' else {}))
        self.browser.value('new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))')


def look_at_curves(browser, report, summary):
    """Wheel, drag and keys zoom all figures over time together; the pointer reads them; a click moves the animation."""
    r = Reader(browser, 'acceleration')
    low, high = r.sees()['x']
    at = lambda part: low + part * (high - low)
    browser.value('document.activeElement.blur()')
    r.wheel(.5, -120)
    check(not r.sees()['ticks'], report, 'the wheel zooms a figure that nobody chose')
    r.click(.25)
    shown = float(browser.value("document.querySelector('#player output').textContent").split()[0])
    check(abs(shown - at(.25)) < .005 * (high - low), report, f'a click at {at(.25):.4f} s shows {shown} s')
    before = r.sees()['scroll']
    for _ in range(6):
        r.wheel(.25, -120)
    time.sleep(.3)
    ticks = r.sees()['ticks']
    check(len(ticks) > 1 and ticks[0] < at(.25) < ticks[-1] and ticks[-1] - ticks[0] < .35 * (high - low), report, f'the wheel shows {ticks}')
    check(r.sees()['scroll'] == before, report, 'the wheel scrolls the page under a figure that is chosen')
    check(r.sees('joint')['ticks'] != [], report, 'the figures are not zoomed together')
    wide = r.sees()['ticks']
    r.key('+')
    narrow = r.sees()['ticks']
    check(narrow[-1] - narrow[0] < .8 * (wide[-1] - wide[0]), report, f'+ zooms from {wide} to {narrow}')
    r.key('ArrowRight', modifiers=8)
    check(r.sees()['ticks'][-1] > narrow[-1], report, 'Shift and an arrow do not pan')
    r.key('0')
    check(not r.sees()['ticks'] and not r.sees('joint')['ticks'], report, '0 does not show the whole')
    r.drag(.2, .4)
    ticks = r.sees()['ticks']
    check(len(ticks) > 1 and at(.2) - 1e-3 <= ticks[0] and ticks[-1] <= at(.4) + 1e-3 and
          ticks[-1] - ticks[0] > .5 * (at(.4) - at(.2)), report, f'a drag from {at(.2)} to {at(.4)} s shows {ticks}')
    r.drag(.7, .3, modifiers=8)
    check(r.sees()['ticks'][-1] > ticks[-1], report, 'Shift and a drag do not pan')
    r.click(.5, count=2)
    check(not r.sees()['ticks'], report, 'a double click does not show the whole')
    peaks = summary.get('peaks')
    if isinstance(peaks, list) and peaks:
        highest = max(peaks, key=lambda p: p['acceleration'])
        part = (highest['t'] - low) / (high - low)
        r.drag(part - .02, part + .02)
        r.mouse('mouseMoved', .5)
        values = [float(n) for n in r.sees()['read'].replace(';', ' ').split() if n.replace('.', '', 1).isdigit()]
        check(any(abs(v - highest['acceleration']) < .03 * highest['acceleration'] for v in values[1:]), report,
              f"at the peak of {highest['acceleration']:.1f} the pointer reads {r.sees()['read']}")
        cursor = "document.querySelector('#figure-acceleration .cursor').style.display"
        browser.value(f"slide({highest['t']})")
        check(browser.value(cursor) == '', report, 'the time of the animation is not in the zoomed figure')
        browser.value(f'slide({high})')
        check(browser.value(cursor) == 'none', report, 'a time that is not shown has a cursor')
        read = r.sees()['read']
        r.key('ArrowRight')
        check(r.sees()['read'] != read, report, 'an arrow does not move the reading')
    browser.value("document.querySelector('#figure-acceleration .look button:last-child').click()")
    check(not r.sees()['ticks'], report, 'the button "whole" does nothing')


def look_at_map(browser, report):
    """The pointer on a heat map reads off the value that the map holds there."""
    said = browser.value("""(() => {
      const svg = document.querySelector('svg.map'), data = JSON.parse(svg.querySelector('metadata').textContent);
      const [left, top, width, height] = data.inside, box = svg.getBoundingClientRect(), scale = box.width / 640;
      const i = data.x.length - 1, j = 0;
      svg.dispatchEvent(new PointerEvent('pointermove', {clientX: box.left + (left + width * (i + .5) / data.x.length) * scale,
        clientY: box.top + (top + height * (1 - (j + .5) / data.y.length)) * scale}));
      return svg.parentNode.querySelector('.said').textContent + '|' + data.x[i] + '|' + data.y[j] + '|' + data.values[i];
    })()""")
    text, x, y, value = said.split('|')
    check(f' {x},' in text and f' {y}: ' in text and text.endswith(value.replace('null', 'none')), report, 'a map reads ' + said)


def look(browser, report, path, summary, pictures):
    animated = 'id="landings"' in open(path, encoding='utf-8').read()
    check(os.path.getsize(path) < 2e6, report, f'{os.path.getsize(path)} bytes')
    for width in (1280, 390):
        for scheme in ('light', 'dark'):
            browser.ask('Emulation.setDeviceMetricsOverride', width=width, height=900, deviceScaleFactor=1, mobile=False)
            browser.ask('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': scheme}])
            browser.open(path)
            where = f'{report}, {width} px, {scheme}'
            check(browser.value(OVERFLOW) == '', where, browser.value(OVERFLOW))
            check(browser.value(OVERLAP) == '', where, browser.value(OVERLAP))
            check(not animated or browser.value(STAGE) == '', where, animated and browser.value(STAGE))
            check(browser.value(FIRST_SCREEN) == '', where, browser.value(FIRST_SCREEN))
            if pictures:
                browser.picture(f'{pictures}/{report}_{width}_{scheme}.png')
            if width == 1280 and scheme == 'light' and animated:
                look_at_animation(browser, report, summary)
                look_at_curves(browser, report, summary)
            if width == 1280 and scheme == 'light' and 'class="map"' in open(path, encoding='utf-8').read():
                look_at_map(browser, report)
            for fault in errors_and_requests(browser):
                check(False, where, fault)
    browser.ask('Emulation.setScriptExecutionDisabled', value=True)
    browser.open(path)
    drawn = browser.ask('DOM.getDocument', depth=-1)['root']
    text = json.dumps(drawn)
    if animated:
        check('figure-postures' in text, report, 'without script no postures stand')
    check('"SVG"' in text.upper() or report.startswith('plain'), report, 'without script no figure stands')
    browser.ask('Emulation.setScriptExecutionDisabled', value=False)


def made(program, data, folder):
    """Reports of the verbs, each in a folder of its name; a trial has a name that would run if it were not escaped."""
    trial = os.path.join(folder, '<img src=x onerror=alert(1)>.csv')
    shutil.copy(data + '/impact/trial_1.csv', trial)
    scene = [data + '/scenes/paper.toml', '--actuator', data + '/actuators/table2.toml']
    trials = [trial] + [f'{data}/impact/trial_{i}.csv' for i in range(2, 9)]
    rig = ['--rig', data + '/rigs/paper.toml']
    runs = {
        'simulate': ['simulate', *scene, '--hold', '-30'],
        'links': ['simulate', data + '/scenes/foot.toml'],
        'hopper': ['simulate', data + '/scenes/hopper.toml'],
        'robot': ['robot', data + '/scenes/foot.toml'],
        'trade': ['trade', data + '/scenes/hopper.toml', '--vary', 'drive.knee.k_p=20:100:3', '--evaluations', '400'],
        'optimize': ['optimize', *scene, '--evaluations', '2000'],
        'robust': ['optimize', *scene, '--robust', 'cvar', '--evaluations', '20000'],
        'predict': ['predict', trials[7], *rig, '--actuator', data + '/actuators/table2.toml'],
        'identify': ['identify', *trials, *rig],
        'compare': ['compare', '--nominal', data + '/actuators/x8-9_nominal.toml', '--identified',
                    data + '/actuators/table2.toml', '--scene', data + '/scenes/paper.toml'],
        'risk': ['risk', *scene, '--hold', '-45', '--samples', '500'],
        'ladder': ['identify', *trials[1:4], *rig, '--diagnose', '--profile', 'k_sea'],
        'calibrate': ['calibrate', *(f'{data}/drops/drop_{i}.csv' for i in (1, 2, 3)), '--scene', data + '/drops/first_guess.toml',
                      '--actuator', data + '/actuators/table2.toml', '--motion', data + '/drops/hold.toml', '--motion-of',
                      f'drop_3={data}/drops/bend.toml', '--height-of', 'drop_2=0.25'],
        'map': ['map', *scene, '--grid', '12,12,6'],
        'ratings': ['ratings', *scene, '--motor-speed', '3:9:3', '--evaluations', '300'],
        'design': ['design', *trials[:2], *rig, '--actuator', data + '/actuators/table2.toml', '--hits', '1', '--check', '0'],
    }
    for name, arguments in runs.items():
        done = subprocess.run([program, *arguments, '--quiet', '-o', os.path.join(folder, name)], capture_output=True, text=True)
        if not os.path.exists(os.path.join(folder, name, 'report.html')):
            check(False, name, 'no report: ' + done.stderr[-500:])
            continue
        yield name


def main():
    chromium = shutil.which('chromium') or shutil.which('chromium-browser')
    if not chromium:
        print('skipped: there is no chromium here')
        return 77
    program, data, pictures = sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else ''
    if pictures:
        os.makedirs(pictures, exist_ok=True)
    folder = tempfile.mkdtemp()
    browser = Browser(chromium)
    try:
        for name in made(program, data, folder):
            path = os.path.join(folder, name, 'report.html')
            with open(os.path.join(folder, name, 'summary.json'), encoding='utf-8') as f:
                look(browser, name, path, json.load(f), pictures)
    finally:
        browser.close()
        shutil.rmtree(folder, ignore_errors=True)
    print('\n'.join(faults) if faults else 'every report is as it should be')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
