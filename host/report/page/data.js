// The data of the page: numbers, and the cloud in typed arrays.

const data = JSON.parse(document.getElementById('data').textContent);
const report = data.report;

const bytes_per_point = 8;  // x y z of 16 bits, beats, fate: 0 fired, 1 missed, 2 not reached, 3 fired before

// The bytes of the cloud. One pass, no copy but the text itself, which is released.
function cloud_bytes() {
  const element = document.getElementById('cloud');
  const text = atob(element.textContent.trim());
  element.textContent = '';
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// 1234567 -> 1 234 567, with spaces that do not break.
function grouped(number) {
  return String(number).replace(/\B(?=(\d{3})+(?!\d))/g, '\u00a0');
}

function fixed(number, digits) {
  return Number(number).toFixed(digits);
}

// A number with three or four significant digits.
function short(number) {
  if (number === 0) return '0';
  const digits = Math.max(0, 2 - Math.floor(Math.log10(Math.abs(number))));
  return Number(number).toFixed(Math.min(digits, 6));
}

// As duration_text() of the program.
function time_text(seconds) {
  if (Math.round(100 * seconds) < 6000) return `${fixed(seconds, 2)} s`;
  const whole = Math.round(seconds);
  const two = (n) => String(n).padStart(2, '0');
  const minutes = Math.floor(whole / 60) % 60;
  if (whole < 3600) return `${minutes} min ${two(whole % 60)} s`;
  return `${Math.floor(whole / 3600)} h ${two(minutes)} min ${two(whole % 60)} s`;
}

// Beat at a place of the job, a fraction from 0 to 1; null if unknown.
function beat_at(share) {
  if (data.clock.length === 0) return null;
  const at = share * (data.clock.length - 1);
  const i = Math.min(Math.floor(at), data.clock.length - 2);
  return data.clock[i] + (at - i) * (data.clock[i + 1] - data.clock[i]);
}

const seconds_per_beat = report.beats > 0 ? report.time_s / report.beats : 1 / report.lamp_hz;
