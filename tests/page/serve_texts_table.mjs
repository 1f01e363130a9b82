// The texts of the page of `lamplock serve`: each is in the table of page/texts.json, and each entry
// of the table is used, by the page or by a refusal of the server, whose sources are beside the page.
//
// usage: node serve_texts_table.mjs FOLDER_OF_THE_PAGE
// exit status: 0 passed; 1 failed; 2 usage

import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';

const [folder] = process.argv.slice(2);
if (folder === undefined) {
  console.log('usage: node serve_texts_table.mjs FOLDER_OF_THE_PAGE');
  process.exit(2);
}
const read = (name) => readFileSync(join(folder, name), 'utf8');
const table = JSON.parse(read('texts.json'));
const html = read('page.html');
const scripts = readdirSync(folder).filter((name) => name.endsWith('.js')).map((name) => [name, read(name)]);

let failures = 0;
function check(what, wrong) {
  console.log(`${wrong.length === 0 ? 'ok    ' : 'FAILED'}  ${what}${wrong.length === 0 ? '' : `: ${JSON.stringify(wrong)}`}`);
  failures += wrong.length > 0;
}

// What a translation does not change: axes, steps, signs, the name of the program.
const neutral = /^(lamplock|[XYZA][+−]?|[-+−0-9. \u00a0])*$/;
const placeholder = /\{\{[^}]+\}\}/g;
const entities = (text) => text.replaceAll('&minus;', '−').replaceAll('&nbsp;', ' ');
const words = entities(html.replace(/<script[^>]*>.*?<\/script>/gs, '').replace(/<[^>]*>/g, '\n').replace(placeholder, '')).split('\n');
check('page.html has no text of its own', words.map((text) => text.trim()).filter((text) => !neutral.test(text)));
const attributes = [...html.matchAll(/ (?:aria-label|alt|title|placeholder|lang)="([^"]*)"/g)].map(([, text]) => text);
check('attributes of page.html have none', attributes.filter((text) => text.replace(placeholder, '') !== ''));

// Literals of a script without its comments. A text has a space between words, or is written by
// its own into the page.
const code_of = (script) => script.replace(/^\s*\/\/.*$/gm, '').replace(/`#version[^`]*`/g, '');
const keys_of = (code) => [...code.matchAll(/'([a-z][a-z0-9-]*(?:\.[a-z0-9-]+)*)'/g)].map(([, name]) => name);
const literals_of = (code) => [...code.matchAll(/'([^'\n]*)'|`([^`]*)`/g)].map(([, plain, mixed]) => (plain ?? mixed.replace(/\$\{[^}]*\}/g, '')));
const is_prose = (text) => /[A-Za-z]{2,}[,;:]? +[A-Za-z]{2,}/.test(text) && !/sans-serif$|^\(prefers-/.test(text);
const in_html = [...html.matchAll(/\{\{([^}]+)\}\}/g)].map(([, name]) => name);
const used = new Set(in_html);
for (const [name, script] of scripts) {
  const code = code_of(script);
  check(`${name} has no text of its own`, [
    ...literals_of(code).filter(is_prose),
    ...[...code.matchAll(/textContent\s*=\s*('[^']*'|`[^`]*`)/g)].map(([, text]) => text)
      .filter((text) => /[A-Za-z]/.test(text.replace(/\$\{[^}]*\}/g, ''))),
    ...[...code.matchAll(/(?:show_problem|new Error)\('[^']*[A-Za-z][^']*'\)/g)].map(([text]) => text)]);
  // text('name'), text(a ? 'name' : 'name')
  const asked = [...code.matchAll(/\btext\(([^(){}]*?)[,)]/g)].flatMap(([, argument]) => keys_of(argument.replace(/=== '[^']*'/g, '')));
  asked.forEach((key) => used.add(key));
  check(`${name}: the table has what it asks for`, asked.filter((key) => !(key in table)));
}
// Names that are not arguments of text(), and groups whose codes the server sends.
for (const [, script] of scripts) {
  keys_of(code_of(script)).filter((key) => key in table).forEach((key) => used.add(key));
  for (const [, group] of code_of(script).matchAll(/\bword\('([a-z-]+)'/g))
    Object.keys(table).filter((key) => key.startsWith(`${group}.`)).forEach((key) => used.add(key));
}
const server = join(folder, '..');
const refusals = readdirSync(server).filter((name) => name.endsWith('.cpp')).flatMap((name) =>
  [...readFileSync(join(server, name), 'utf8').matchAll(/Refusal\(Exit::\w+, "([a-z-]+)"/g)].map(([, refusal]) => `error.${refusal}`));
check('the server refuses by names of the table', refusals.filter((key) => !(key in table)));
refusals.forEach((key) => used.add(key));
check('the table has what page.html asks for', in_html.filter((key) => !(key in table)));
check('each entry of the table is used', Object.keys(table).filter((key) => !used.has(key)));
console.log(failures === 0 ? 'passed' : `${failures} failed`);
process.exit(failures === 0 ? 0 : 1);
