// State and controls of the page: the open scene, its numbers, and the engine's answers.
(() => {
  const node = id => document.getElementById(id);
  const {element} = fall;
  const base = path => path.replace(/^.*[/\\]/, '');

  // --- the engine, in a worker: one request at a time ---
  const worker = new Worker(URL.createObjectURL(new Blob([node('engine').textContent], {type: 'text/javascript'})));
  worker.postMessage(node('wasm').textContent);
  const waiting = [];
  const ask = question => new Promise(answer => {
    waiting.push({question, answer});
    if (waiting.length === 1) worker.postMessage(question);
  });
  worker.onmessage = ({data}) => {
    waiting.shift().answer(data);
    if (waiting.length) worker.postMessage(waiting[0].question);
  };

  // --- files: shipped ones by path, opened ones by name ---
  const shipped = new Map([...document.querySelectorAll('script.file')].map(s => [s.dataset.path, s.textContent]));
  const kind = text => /^\s*\[drop\]/m.test(text) ? 'scene' : /^\s*\[\[robot\.link\]\]/m.test(text) ? 'robot'
    : /^\s*\[actuator\]/m.test(text) ? 'actuator' : 'other';
  const ofLinks = text => /^\s*robot\s*=/m.test(text) || /^\s*\[\[robot\.link\]\]/m.test(text);
  const references = text => [...text.replace(/#.*$/gm, '').matchAll(/\b(?:robot|file)\s*=\s*"([^"]+)"/g)].map(m => m[1]);
  // Text of the file at a path relative to the scenes' folder; `referrer`: name of the file that refers to it.
  const textAt = (path, opened, referrer) => {
    const name = base(path);
    if (opened.has(name) && name !== referrer) return opened.get(name);
    const text = shipped.get(new URL(path, 'file:///scenes/').pathname.slice(1));
    if (text === undefined) throw new Error(`${name} is missing: open it together with ${referrer}, which names it.`);
    return text;
  };
  // A file and all files that it refers to, by path. Throws where one is missing.
  const gathered = (path, opened, referrer = '', out = {}) => {
    out[path] = textAt(path, opened, referrer);
    for (const name of references(out[path])) {
      const next = name.startsWith('/') ? name : path.replace(/[^/]*$/, '') + name;
      if (!(next in out)) gathered(next, opened, base(path), out);
    }
    return out;
  };
  // A scene for a robot without one: a drop on an assumed floor.
  const dropOf = (name, text) => `# ${name}, dropped on a floor that is assumed.
robot = "${name}"

[floor]
stiffness = 20000          # N/m
damping_normal = 120       # N/(m/s)
friction = 0.6
damping_tangential = 40    # N/(m/s)
source = "assumed"

[drop]
${/^\s*base\s*=\s*"pinned"/m.test(text) ? '' : 'height = 0.3               # m\n'}pitch_deg = 0
`;

  // --- what is open ---
  let open = null;       // files, scene, actuator and its words, changed numbers, motion (null: held)
  let controls = null;   // adjustable numbers, as answered by the engine
  const question = (what, more) => ({...open, ...more, do: what});
  const showError = text => { node('error').textContent = text; };
  const setReady = ready => { document.body.dataset.state = ready ? 'ready' : 'busy'; };

  const openScene = async (name, opened, actuator) => {
    setReady(false);
    showError('');
    try {
      const files = gathered(name, opened);
      const scene = {files, scene: name, actuator, actuatorWords: actuator, numbers: {}, motion: null};
      if (!actuator && !ofLinks(files[name]))
        scene.actuator = '../actuators/table2.toml', scene.actuatorWords = 'datasets/actuators/table2.toml';
      if (scene.actuator) Object.assign(files, gathered(scene.actuator, opened));
      const answer = await ask({...scene, do: 'open'});
      if (answer.error) throw new Error(answer.error);
      open = scene, controls = answer;
      build();
      await land();
    } catch (error) {
      showError(error.message);
    }
    setReady(true);
  };

  const openFiles = async list => {
    const opened = new Map(await Promise.all([...list].map(async file => [file.name, await file.text()])));
    const names = wanted => [...opened.keys()].filter(name => kind(opened.get(name)) === wanted);
    const [robot] = names('robot');
    let [scene] = names('scene');
    if (!scene && robot) {
      scene = robot.replace(/(\.toml)?$/, '_drop.toml');
      opened.set(scene, dropOf(robot, opened.get(robot)));
    }
    // Any other file is passed to the engine, whose error says what it lacks.
    scene = scene || [...opened.keys()][0];
    const uses = [...opened.values()].flatMap(references).map(base);
    await openScene(scene, opened, names('actuator').find(name => !uses.includes(name)) || '');
    scenes.value = '';
  };

  // --- adjustable numbers ---
  const degrees = unit => unit === 'rad' ? 180 / Math.PI : 1;
  const shownUnit = unit => unit === 'rad' ? '°' : unit === 'deg' ? '°' : unit === '1' ? '' : ' ' + unit;
  const shown = (value, unit) => Number((value * degrees(unit)).toPrecision(4)) + shownUnit(unit);
  const words = name => {
    const [, what, joint] = /^(phi_i|phi_f|duration|b\d|gain_p|gain_d|to)(?:_(.+))?$/.exec(name) || [null, name];
    const of = joint || 'knee';
    return {phi_i: `${of}, until the touchdown`, phi_f: `${of}, at the end`, duration: joint ? `time of ${joint}'s motion` : 'time of the motion',
            gain_p: `${of}, factor of K_p`, gain_d: `${of}, factor of K_d`, to: 'end of the move in the air'}[what] || `${of}, shape term ${what}`;
  };
  // A slider over a range, linear or logarithmic.
  class Slider {
    constructor(n, label, parent, moved) {
      this.n = n;
      const row = element('label', parent);
      row.className = 'number';
      element('span', row, label);
      this.said = element('output', row);
      this.input = element('input', row);
      Object.assign(this.input, {type: 'range', min: 0, max: 1, step: 'any', name: n.name});
      this.input.addEventListener('input', () => { this.say(this.value()); moved(this.value()); });
      this.show(n.value);
    }
    value() {
      const part = Number(this.input.value), {low, high, logarithmic} = this.n;
      return logarithmic ? low * (high / low) ** part : low + part * (high - low);
    }
    say(value) { this.said.textContent = shown(value, this.n.unit); }
    show(value) {
      const {low, high, logarithmic} = this.n;
      this.input.value = logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
      this.say(value);
    }
  }
  let motionSliders = [];
  const group = (title, numbers, form, add) => {
    if (!numbers.length) return [];
    const set = element('fieldset', form);
    element('legend', set, title);
    return numbers.map(n => add(n, set));
  };
  const build = () => {
    const form = node('numbers');
    form.replaceChildren();
    const ofScene = (n, set) => new Slider(n, n.words, set, value => { open.numbers[n.name] = value; land(); });
    motionSliders = group('Motion', controls.motion, form, (n, set) => new Slider(n, words(n.name), set, () => {
      open.motion = motionSliders.map((s, k) => s.n.name === n.name ? s.value() : open.motion ? open.motion[k] : s.n.value);
      land();
    }));
    group('Drop', controls.numbers.filter(n => n.name.startsWith('drop.')), form, ofScene);
    group('Floor', controls.numbers.filter(n => n.name.startsWith('floor.')), form, ofScene);
  };
  const showMotion = () => motionSliders.forEach((s, k) => s.show(open.motion ? open.motion[k] : s.n.value));

  // --- landing; of several requests only the latest is shown ---
  let player = null, landing = false, pending = false;
  const show = answer => {
    showError(answer.error || answer.failure || '');
    if (answer.error) return;
    const sentence = node('sentence');
    sentence.textContent = answer.failure ? 'There is no landing.' : answer.sentence.replace('m/s^2', 'm/s²');
    sentence.dataset.peak = answer.peak, sentence.dataset.held = answer.held;
    node('doubts').replaceChildren(...answer.doubts.map(text => {
      const item = document.createElement('li');
      item.textContent = text;
      return item;
    }));
    const before = player;
    if (before) before.pause();
    node('player').replaceChildren();
    player = new fall.Player(answer, node('player'));
    if (before) player.speed.value = before.speed.value, player.pauses.checked = before.pauses.checked;
    curves.show(node('curve'), answer.landings);
    const motion = open.motion ? ' --motion motion.toml' : controls.hold && ' ' + controls.hold;
    node('command').textContent = `ukemi simulate ${open.scene}${open.actuator && ' --actuator ' + open.actuatorWords}${motion}`;
    node('save-motion').disabled = !open.motion;
    node('plan').disabled = node('hold').disabled = !controls.motion.length;
  };
  const land = async () => {
    pending = true;
    if (landing) return;
    landing = true;
    setReady(false);
    while (pending) {
      pending = false;
      show(await ask(question('land')));
    }
    landing = false;
    setReady(true);
  };

  // --- buttons ---
  node('plan').addEventListener('click', async () => {
    const button = node('plan'), before = button.textContent;
    setReady(false);
    button.disabled = true, button.textContent = 'Planning …';
    const answer = await ask(question('plan', {seconds: 1}));
    button.disabled = false, button.textContent = before;
    if (answer.motion) open.motion = answer.motion, showMotion();
    await land();
    if (!answer.motion) showError(answer.error || 'No motion was found that can be followed.');
  });
  node('hold').addEventListener('click', () => { open.motion = null; showMotion(); land(); });
  node('reset').addEventListener('click', () => { open.numbers = {}, open.motion = null; build(); land(); });
  const download = (name, text) => {
    const link = element('a', document.body);
    Object.assign(link, {href: URL.createObjectURL(new Blob([text], {type: 'application/toml'})), download: name});
    link.click();
    link.remove();
  };
  const save = async what => {
    const answer = await ask(question('save'));
    if (answer.error) return showError(answer.error);
    download(what === 'scene' ? open.scene : 'motion.toml', answer[what]);
  };
  node('save').addEventListener('click', () => save('scene'));
  node('save-motion').addEventListener('click', () => save('motion'));
  node('open').addEventListener('change', async event => {
    await openFiles(event.target.files);
    event.target.value = '';  // so that the same file can be opened again
  });

  const scenes = node('scenes');
  for (const path of shipped.keys())
    if (path.startsWith('scenes/')) Object.assign(element('option', scenes, base(path).replace('.toml', '')), {value: base(path)});
  scenes.addEventListener('change', () => openScene(scenes.value, new Map(), ''));
  openScene(scenes.value, new Map(), '');
})();
