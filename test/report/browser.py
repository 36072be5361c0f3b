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

    def picture(self, path):
        height = self.value('document.documentElement.scrollHeight')
        width = self.value('innerWidth')
        data = self.ask('Page.captureScreenshot', captureBeyondViewport=True,
                        clip={'x': 0, 'y': 0, 'width': width, 'height': min(height, 12000), 'scale': 1})['data']
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
            check(report == 'robot' or browser.value(FIRST_SCREEN) == '', where, browser.value(FIRST_SCREEN))
            if pictures:
                browser.picture(f'{pictures}/{report}_{width}_{scheme}.png')
            if width == 1280 and scheme == 'light' and animated:
                look_at_animation(browser, report, summary)
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
        'robot': ['robot', data + '/scenes/foot.toml'],
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
