// One small image with its script in rp2040js.
//
// usage: node run_image.mjs IMAGE.uf2 SCRIPT [clocked] [inputs]
//   clocked  its PIO is stepped once a cycle; inputs  inputs of pads are on after reset
// prints JSON: { results: [{ says, met, seen }], stopped: the simulator's error, if any }.
// An expectation without `met` was not reached.

import { readFileSync, writeSync } from 'node:fs';

import { read_script } from './script.mjs';
import { ScriptRun } from './script_run.mjs';
import { Scene } from './script_scene.mjs';
import { enable_inputs, run_in_rp2040js } from './small_run.mjs';
import { read_uf2 } from './uf2.mjs';

const until_ms = 2000;  // as in the tests chip_images.*

// rp2040js writes to the console on every access, millions of times.
for (const level of ['debug', 'info', 'log', 'warn', 'error']) console[level] = () => {};

const [image, script, ...helps] = process.argv.slice(2);
let run;
let stopped;
try {
  run_in_rp2040js(read_uf2(readFileSync(image)), until_ms, helps.includes('clocked'), (rp2040, clock) => {
    if (helps.includes('inputs')) enable_inputs(rp2040);
    run = new ScriptRun(new Scene(rp2040, clock), read_script(readFileSync(script, 'utf8')));
    return () => run.done;
  });
} catch (error) {
  stopped = error.message;
}
writeSync(1, JSON.stringify({ results: run?.results ?? [], stopped }));
process.exit(0);  // rp2040js runs its PIO by timers of the host, which never end
