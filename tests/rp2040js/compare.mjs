// Small images in `lamplock chip` and in rp2040js, edge by edge, against what the manuals say.
//
// usage: node compare.mjs LAMPLOCK [--list] CASE.json ...
//
// A case names an image (assembler source or UF2, next to it), how long to run, the pins and their
// edges in cycles of clk_sys since the first edge of the pin `origin`, and the sections that decide.
// `rp2040js` is what that simulator does instead, where it differs; `rp2040js_clocked` the same with
// its PIO stepped once a cycle. An edge of `lamplock chip` that is not as expected, or a difference
// of rp2040js that the case does not list, or lists and is gone, is an error.
//
// exit status: 0 all as listed; 1 not; 2 wrong use; 77 rp2040js is not installed (toolchain/setup)

import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { isDeepStrictEqual } from 'node:util';

import { case_image } from './case_image.mjs';

const not_there = 77;
const { cycles_of, edges_in_lamplock, edges_in_rp2040js } = await import('./edges.mjs').catch((error) => {
  if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
  console.log('rp2040js is not installed; run toolchain/setup');
  process.exit(not_there);
});

const ms_of = (time) => parseFloat(time) * { us: 1e-3, ms: 1, s: 1e3 }[time.match(/[a-z]+$/)[0]];

function show(name, edges) {
  for (const [pin, cycles] of Object.entries(edges)) console.log(`    ${name.padEnd(18)} ${pin} ${cycles.join(' ')}`);
}

/** True if `seen` is what the case says of `name`; prints what is not. */
function as_listed(name, seen, listed) {
  if (isDeepStrictEqual(seen, listed)) return true;
  console.log(`  FAILED  ${name} is not as listed`);
  show('listed', listed);
  show('seen', seen);
  return false;
}

function run_case(program, file, list) {
  const what = JSON.parse(readFileSync(file, 'utf8'));
  const image = case_image(join(dirname(file), what.image));
  const counts = Object.fromEntries(Object.entries(what.edges).map(([pin, edges]) => [pin, edges.length]));
  const relative = (edges) => cycles_of(edges, what.origin, counts, what.clk_sys);
  console.log(what.what);
  let good = as_listed('lamplock chip', relative(edges_in_lamplock(program, image, what.until)), what.edges);
  if (list) show('lamplock chip', what.edges);
  const others = [['rp2040js', false], ['rp2040js_clocked', true]].filter(([name, clocked]) => !clocked || name in what);
  for (const [name, clocked] of others) {
    const seen = relative(edges_in_rp2040js(image, ms_of(what.until), clocked));
    good = as_listed(name, seen, what[name] ?? what.edges) && good;
    const same = isDeepStrictEqual(seen, what.edges);
    console.log(`  ${name.replace('_', ', ')}: ${same ? 'the same' : 'differs'}`);
    if (list && !same) show(name, seen);
  }
  console.log(`    ${what.decides}`);
  return good;
}

const files = process.argv.slice(2);
const program = files.shift();
const list = files[0] === '--list' && files.shift() !== undefined;
if (files.length === 0) {
  console.log('usage: node compare.mjs LAMPLOCK [--list] CASE.json ...');
  process.exit(2);
}
const good = files.map((file) => run_case(program, file, list)).every(Boolean);
console.log(good ? 'ok: all as listed' : 'FAILED');
process.exit(good ? 0 : 1);  // rp2040js runs its PIO by timers of the host, which would never end
