// The page of `lamplock serve` in another language: a translation in which each text is in brackets
// except one, which has to appear in English. What the page shows without brackets is data.
//
// usage: node serve_texts.mjs LAMPLOCK [FOLDER_FOR_PICTURES]
// exit status: 0 passed; 1 failed; 77 no Chromium (toolchain/setup test, or the variable CHROMIUM)

import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { Browser } from './browser.mjs';
import { check, chromium, drop, end, folder, keep_picture, open, program, start_server, text_of, until } from './serve_tools.mjs';

const missing = 'machine.home';

function make_translation() {
  const english = join(folder, 'english.json'), file = join(folder, 'brackets.json');
  const written = spawnSync(program, ['serve', '--write-texts', english]);
  check('the English texts are written', written.status === 0, String(written.stderr));
  const texts = Object.entries(JSON.parse(readFileSync(english, 'utf8'))).filter(([name]) => name !== missing);
  writeFileSync(file, JSON.stringify(Object.fromEntries(texts.map(([name, text]) => [name, name === 'language' ? 'de' : `⟦${text}⟧`]))));
  return file;
}

// Texts and labels with letters outside of brackets. Data: names of files, boards and settings,
// lines of the console, axes.
const bare = (page) => page.ask(`(() => {
  const data = '#board, #lines, #jobs, #models, #object, #macro-names, #settings label, #settings td:last-child, #history td:nth-child(-n+3), #materials td:nth-child(-n+2), #materials td:last-child, script, style, h1';
  const without = (text) => {
    for (let before = ''; before !== text;) [before, text] = [text, text.replace(/⟦[^⟦⟧]*⟧/g, '')];
    return text;
  };
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = walker.nextNode());)
    if (!node.parentElement.closest(data)) found.push(node.data);
  for (const each of document.querySelectorAll('[aria-label], [alt], [title]'))
    found.push(each.getAttribute('aria-label') ?? each.getAttribute('alt') ?? each.title);
  return found.map(without).map((text) => text.replace('line.ngc ·', '')).filter((text) => /[A-Za-z]{2}|[a-z]/.test(text)).map((text) => text.trim());
})()`);

async function expect_translated(page, what) {
  const found = await bare(page);
  check(`${what}: every text is of the table, one is English`, found.length === 1 && found[0] === 'Home', found);
}

const model = ['0 0 0', '10 0 0', '10 10 5', '0 10 5'].join('\n');

let server;
try {
  server = await start_server('--texts', make_translation());
  const browser = new Browser(chromium, { webgl: false });
  const page = await open(browser, server, {});
  check('the document names its language', await page.ask('document.documentElement.lang') === 'de');
  await expect_translated(page, 'connected');
  check('the state of the board is translated', await text_of(page, 'state') === '⟦Idle⟧', await text_of(page, 'state'));
  await drop(page, 'line.ngc', 'G21G90\nG1X5F600\n');
  await until('the program is checked', async () => /mm⟧/.test(await text_of(page, 'checked')));
  await page.click('#view-area');
  await until('the work space is shown', () => page.ask(`!document.getElementById('view').hidden`));
  // From the lowest list to the highest one, because each list moves what is below it.
  await page.click('#read');
  await until('settings are read', () => page.ask(`document.querySelectorAll('#settings tr').length > 50`));
  await page.click('#materials-read');
  await until('materials are read', () => page.ask(`document.querySelectorAll('#materials tbody tr').length > 0`));
  await page.click('#history-read');
  await until('there is no history', async () => /⟦/.test(await text_of(page, 'history-text')));
  await expect_translated(page, 'lists, settings, work space');
  await drop(page, 'corners.xyz', model);
  await until('the model is listed', () => page.ask(`document.getElementById('models').value === 'corners.xyz'`));
  await drop(page, 'bad.exe', 'MZ');
  await until('a refusal of the server is translated', async () => /^⟦bad\.exe: .*⟧$/.test(await text_of(page, 'problem')));
  await page.click('#place');
  await until('the object is shown', () => page.ask(`!document.getElementById('placing').hidden`));
  await page.click('#object-remove');
  await until('a refusal of the page is shown', async () => /⟦/.test(await text_of(page, 'problem')));
  await expect_translated(page, 'placement');
  await keep_picture(page, 'serve-texts');
  await page.click('#control');
  await until('control is released', () => page.ask(`document.getElementById('delete').disabled`));
  await expect_translated(page, 'watching');
  await page.click('#control');
  await until('control is taken', () => page.ask(`!document.getElementById('delete').disabled`));
  await page.ask(`document.getElementById('jobs').value = 'line.ngc'`);
  await page.ask(`document.getElementById('dry').checked = true`);
  await page.click('#start');
  await until('the history has the program', () => page.ask(
      `(document.getElementById('history-read').click(), document.querySelectorAll('#history tbody tr').length === 1)`));
  await until('the end of a job is translated', async () => /^line\.ngc · ⟦done⟧$/.test(await text_of(page, 'job-text')));
  await expect_translated(page, 'a job has ended');
  check('a dry run has its mark', /⟦line\.ngc \(/.test(await text_of(page, 'history')), await text_of(page, 'history'));
  const complaints = page.complaints.filter((text) => !/status of 422/.test(text));  // of the refused file
  check('no complaints', complaints.length === 0, complaints);
  await browser.close();
  server.child.removeAllListeners('exit');
} catch (error) {
  check(error.stack, false);
}
end(server);
