// The camera of the page of `lamplock serve`: a picture of a file, calibrated by four points, in the top
// view.
//
// usage: node serve_camera.mjs LAMPLOCK [FOLDER_FOR_PICTURES]
// exit status: 0 passed; 1 failed; 77 no Chromium (toolchain/setup test, or the variable CHROMIUM)

import { rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { Browser } from './browser.mjs';
import { call, check, chromium, end, folder, keep_picture, open, start_server, text_of, until } from './serve_tools.mjs';

const file = join(folder, 'camera.jpg');
// A trapezoid in the picture, as an inclined camera sees a square.
const points = [
  { u: 0.1, v: 0.9, x: -40, y: -40 }, { u: 0.9, v: 0.9, x: 40, y: -40 },
  { u: 0.75, v: 0.2, x: 40, y: 40 }, { u: 0.25, v: 0.2, x: -40, y: 40 }];

// A picture with the trapezoid and its diagonals, drawn by the browser.
async function make_picture(page) {
  const data = await page.ask(`(() => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [640, 480];
    const context = canvas.getContext('2d');
    context.fillStyle = '#fff3c4';
    context.fillRect(0, 0, 640, 480);
    context.lineWidth = 4;
    context.strokeStyle = '#a0522d';
    const points = ${JSON.stringify(points)};
    for (const a of points) for (const b of points) {
      context.beginPath();
      context.moveTo(a.u * 640, a.v * 480);
      context.lineTo(b.u * 640, b.v * 480);
      context.stroke();
    }
    return canvas.toDataURL('image/jpeg', 0.9);
  })()`);
  writeFileSync(file, Buffer.from(data.split(',')[1], 'base64'));
}

const fill = (page, id, value) => page.ask(`(document.getElementById('${id}').value = '${value}')`);

async function calibrate(page) {
  await page.ask(`(document.getElementById('camera-calibration').open = true)`);
  await until('the picture is shown', () => page.ask(`document.getElementById('camera-plain').naturalWidth === 640`));
  check('it says that it is not calibrated', /not calibrated/.test(await text_of(page, 'camera-text')));
  await page.ask(`document.getElementById('camera-plain').scrollIntoView()`);
  await page.frames(2);
  // The first point by a click, the others by numbers.
  const { x, y } = await page.ask(`(() => {
    const box = document.getElementById('camera-plain').getBoundingClientRect();
    return { x: box.x + box.width * 0.1, y: box.y + box.height * 0.9 };
  })()`);
  await page.mouse('mousePressed', x, y, { button: 'left', buttons: 1, clickCount: 1 });
  await page.mouse('mouseReleased', x, y, { button: 'left', clickCount: 1 });
  const clicked = await page.ask(`['u0', 'v0'].map((id) => Number(document.getElementById('camera-' + id).value))`);
  check('a click enters its place', Math.abs(clicked[0] - 10) < 0.5 && Math.abs(clicked[1] - 90) < 0.5, clicked);
  for (const [i, point] of points.entries())
    for (const [name, value] of Object.entries(point))
      await fill(page, `camera-${name}${i}`, 'uv'.includes(name) ? value * 100 : value);
  await keep_picture(page, 'serve-camera-calibration');
  await page.click('#camera-save');
  await until('the server has the calibration', async () => (await call(server, 'camera.get')).points?.length === 4);
}

// The place of a point of the picture in the view, and what the view says of that place.
async function cursor_at(page, { u, v }) {
  const { x, y } = await page.ask(`(() => {
    const style = getComputedStyle(document.getElementById('camera-picture'));
    const { x, y, w } = new DOMMatrix(style.transform).transformPoint(new DOMPoint(${u * 1000}, ${v * 1000}));
    const box = document.getElementById('camera-box').getBoundingClientRect();
    return { x: box.x + x / w, y: box.y + y / w };
  })()`);
  await page.mouse('mouseMoved', x, y, {});
  await page.frames(2);
  return (await text_of(page, 'cursor')).match(/X (-?[0-9.]+) {2}Y (-?[0-9.]+)/)?.slice(1).map(Number) ?? [];
}

let server;
try {
  server = await start_server('--camera', file);
  const browser = new Browser(chromium, { webgl: false });
  const page = await open(browser, server, {});
  await until('the page has a camera', () => page.ask(`!document.getElementById('camera').hidden`));
  await make_picture(page);
  await calibrate(page);
  await page.ask(`(document.getElementById('camera-calibration').open = false)`);
  await page.click('#camera-show');
  await until('the picture is in the view', () => page.ask(`!document.getElementById('camera-box').hidden`));
  await page.ask(`document.getElementById('view').scrollIntoView()`);
  await page.frames(3);
  await keep_picture(page, 'serve-camera', false);
  // The middle of the square is where its diagonals meet in the picture.
  const middle = { u: 0.5, v: 0.9 - 0.7 * 0.8 / 1.3, x: 0, y: 0 };
  for (const point of [...points, middle]) {
    const found = await cursor_at(page, point);
    check(`the picture has ${point.x}, ${point.y} mm at its place`,
          Math.abs(found[0] - point.x) < 0.4 && Math.abs(found[1] - point.y) < 0.4, found);
  }
  await page.click('#view-in');
  await page.frames(3);
  const found = await cursor_at(page, middle);
  check('it follows the view', Math.abs(found[0]) < 0.4 && Math.abs(found[1]) < 0.4, found);
  rmSync(file);
  await until('an old picture is not shown', () => page.ask(`document.getElementById('camera-box').hidden`), 15_000);
  check('it says why', /camera\.jpg/.test(await text_of(page, 'camera-text')), await text_of(page, 'camera-text'));
  await make_picture(page);
  await until('a new one is shown again', () => page.ask(`!document.getElementById('camera-box').hidden`));
  check('no complaints', page.complaints.filter((text) => !/503/.test(text)).length === 0, page.complaints);
  check('no request to another server', page.requests.every((url) => /^(blob:|ws:\/\/127\.0\.0\.1|data:)/.test(url) || url.startsWith(server.origin)), page.requests);
  await browser.close();
  server.child.removeAllListeners('exit');
} catch (error) {
  check(error.stack, false);
}
end(server);
