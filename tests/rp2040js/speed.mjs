// Measures the speed of rp2040js with an image.
//
// usage: node speed.mjs IMAGE.bin MS [clocked]
// prints JSON: simulated and processor seconds. exit status: 77 rp2040js is not installed

import { readFileSync } from 'node:fs';

const not_there = 77;
const { run_in_rp2040js } = await import('./small_run.mjs').catch((error) => {
  if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
  process.exit(not_there);
});
const [file, ms, clocked] = process.argv.slice(2);
let clock;
const start = process.cpuUsage();
run_in_rp2040js(readFileSync(file), Number(ms), clocked === 'clocked', (_, its) => { clock = its; });
const used = process.cpuUsage(start);
console.log(JSON.stringify({ simulated: clock.nanos / 1e9, cpu: (used.user + used.system) / 1e6 }));
process.exit(0);  // the PIO's timers of the host never end
