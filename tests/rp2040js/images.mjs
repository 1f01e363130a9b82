// The suite of small images (tests/chip_images) in rp2040js: each image with its script, as
// `lamplock chip` runs it in the tests chip_images.*, against the list of differences.
//
// usage: node images.mjs IMAGES PAGE [--table]
//   IMAGES   folder of the images; scripts are those of tests/chip_images
//   PAGE     docs/chip-simulator.md, which has to have the table
//   --table  prints the table and runs nothing
//
// images.json lists for each image the corrections that rp2040js needs, and groups of expectations
// that it does not meet: each as written in the script, with what is seen instead, the section
// that decides, and the reason. A difference that is not listed, or listed but absent, is an error.
//
// exit status: 0 all as listed; 1 not; 2 wrong use; 77 rp2040js is not installed (toolchain/setup)

import { execFileSync } from 'node:child_process';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { isDeepStrictEqual } from 'node:util';

import { read_script } from './script.mjs';

const not_there = 77;
const hangs_ms = 300e3;  // of the host's time; each image takes a few seconds
const here = dirname(fileURLToPath(import.meta.url));
const scripts = join(here, '..', 'chip_images');
const listed = JSON.parse(readFileSync(join(here, 'images.json'), 'utf8'));
const names = readdirSync(scripts).filter((file) => file.endsWith('.script')).map((file) => file.slice(0, -7)).sort();

const differences = (image) => image.groups.flatMap((group) => group.shows);
const read = (name) => read_script(readFileSync(join(scripts, `${name}.script`), 'utf8'));
const expectations = (name) => read(name).filter((step) => step.says !== undefined);
const readable = names.filter((name) => {
  try {
    return read(name);
  } catch (error) {
    console.log(`FAILED  ${name}.script: ${error.message}`);
    return false;
  }
});

/** [expectation, seen instead] of each unmet expectation, in the order of the script. */
function run(name, images) {
  const script = join(scripts, `${name}.script`);
  const helps = listed[name].help ?? [];
  try {
    const out = execFileSync(process.execPath, [join(here, 'run_image.mjs'), join(images, `${name}.uf2`), script, ...helps],
                             { timeout: hangs_ms, stdio: ['ignore', 'pipe', 'ignore'] });
    const { results, stopped } = JSON.parse(out);
    return expectations(name).flatMap(({ says }, i) => {
      const { met, seen } = results[i] ?? {};
      return met === true ? [] : [[says, met === false ? seen : `stops: ${stopped}`]];
    });
  } catch (error) {
    return [['everything', error.code === 'ETIMEDOUT' ? 'hangs' : error.message]];
  }
}

/** True if the image behaves as listed; prints the differences. */
function as_listed(name, images) {
  const seen = run(name, images);
  const left = [...differences(listed[name])];
  const unlisted = seen.filter((each) => {
    const at = left.findIndex((other) => isDeepStrictEqual(each, other));
    if (at >= 0) left.splice(at, 1);
    return at < 0;
  });
  for (const each of unlisted) console.log(`  FAILED  not listed: ${JSON.stringify(each)}`);
  for (const each of left) console.log(`  FAILED  listed, but gone: ${JSON.stringify(each)}`);
  const count = expectations(name).length;
  console.log(`${name}: ${count - seen.length} of ${count} expectations met`);
  return unlisted.length + left.length === 0;
}

const short = (text, length) => (text.length > length ? `${text.slice(0, length - 3)}...` : text);

/** A line of the table for each group of differences. */
function table() {
  const lines = ['| image | met | rp2040js instead | of these the first | decides |', '|---|---|---|---|---|'];
  for (const name of readable) {
    const { groups } = listed[name];
    const count = expectations(name).length;
    const met = `${count - differences(listed[name]).length} of ${count}`;
    if (groups.length === 0) lines.push(`| \`${name}\` | ${met} | the same | | |`);
    groups.forEach(({ why, shows, decides }, i) => {
      const [says, seen] = shows[0];
      const example = `\`${short(says, 60)}\`: ${short(seen, 44)}`;
      const times = shows.length > 1 ? ` (${shows.length})` : '';
      lines.push(`| ${i === 0 ? `\`${name}\` | ${met}` : '|'} | ${why}${times} | ${example} | ${decides} |`);
    });
  }
  return lines.join('\n');
}

const [images, page, option] = process.argv.slice(2);
if (page === undefined) {
  console.log('usage: node images.mjs IMAGES PAGE [--table]');
  process.exit(2);
}
if (!isDeepStrictEqual(Object.keys(listed).sort(), names)) {
  console.log('FAILED  images.json does not list the images of tests/chip_images');
  process.exit(1);
}
if (option === '--table') {
  console.log(table());
  process.exit(0);
}
const all_readable = readable.length === names.length;
const page_good = readFileSync(page, 'utf8').includes(`\n${table()}\n`);
if (!page_good) console.log(`FAILED  ${page} has another table; create it with --table`);
if (page_good && !existsSync(join(here, 'node_modules', 'rp2040js'))) {
  console.log('rp2040js is not installed; run toolchain/setup');
  process.exit(not_there);
}
const good = readable.map((name) => as_listed(name, images)).every(Boolean) && page_good && all_readable;
console.log(good ? 'ok: all as listed' : 'FAILED');
process.exit(good ? 0 : 1);
