// An exported actuator in MuJoCo beside `ukemi predict`: the same hit, the same drive. MuJoCo is the official build for
// WebAssembly:
//     npm install mujoco-js
//     ukemi predict TRIAL.csv --rig RIG.toml --actuator ACTUATOR.toml --export mjcf -o out
//     node test/bench/mujoco.mjs out TRIAL.csv RIG_LENGTH [TIMESTEP]
// For a trial with a force and no reference, and a drive that feeds back the link.
import fs from 'fs';
import path from 'path';
import {createRequire} from 'module';
import {pathToFileURL} from 'url';

const [folder, trial, length, timestep] = process.argv.slice(2);
const load = (await import(pathToFileURL(createRequire(path.resolve('x.js')).resolve('mujoco-js')))).default;
const mujoco = await load();

const xml = fs.readFileSync(folder + '/actuator.mjcf.xml', 'utf8');
mujoco.FS.writeFile('/actuator.xml', timestep ? xml.replace(/timestep="[^"]*"/, `timestep="${timestep}"`) : xml);
const model = mujoco.MjModel.loadFromXML('/actuator.xml'), data = new mujoco.MjData(model);
const [, kP, kD] = xml.match(/ctrl = (\S+) \(phi_ref - \S+\) \+ (\S+) \(/).map(Number);

function table(file) {
  const rows = fs.readFileSync(file, 'utf8').split('\n').filter(line => line && !line.startsWith('#')).map(line => line.split(','));
  return name => rows.slice(1).map(row => Number(row[rows[0].indexOf(name)]));
}
const log = table(trial), t = log('t'), force = log('force'), predicted = table(folder + '/fit.csv')('phi_sim');
const motor = 0, link = 1;
let sum = 0, worst = 0;
for (let k = 0; k < t.length; ++k) {
  while (data.time < t[k] - 1e-9) {
    const part = (data.time - t[k - 1]) / (t[k] - t[k - 1]), pushed = force[k - 1] + part * (force[k] - force[k - 1]);
    data.ctrl[0] = -kP * data.qpos[link] - kD * data.qvel[link];
    data.qfrc_applied[link] = length * pushed * Math.cos(data.qpos[link]);
    mujoco.mj_step(model, data);
  }
  const off = data.qpos[link] - predicted[k];
  sum += off * off, worst = Math.max(worst, Math.abs(off));
}
console.log(`time step ${timestep ?? 'of the file'}: rms ${Math.sqrt(sum / t.length).toExponential(2)} rad, worst ` +
            `${worst.toExponential(2)} rad, largest angle ${Math.max(...predicted.map(Math.abs)).toPrecision(3)} rad; ` +
            `rotor ends ${data.qpos[motor].toExponential(2)} rad`);
