// The image of a case: an assembler source of at most 252 bytes that is its own second-stage boot,
// or a UF2 file.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';

import { read_uf2 } from './uf2.mjs';

const flash_bytes = 2 * 1024 * 1024;
const boot2_bytes = 252;  // without their CRC

/** RP2040 datasheet, 2.8.1.3.1: polynomial 0x04c11db7, initial value all ones, nothing reflected. */
function boot2_crc(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte << 24;
    for (let bit = 0; bit < 8; ++bit) crc = crc << 1 ^ (crc < 0 ? 0x04c11db7 : 0);
  }
  return crc >>> 0;
}

function assemble(file) {
  const folder = mkdtempSync(join(tmpdir(), 'case-'));
  try {
    const object = join(folder, 'case.o');
    const binary = join(folder, 'case.bin');
    execFileSync('arm-none-eabi-as', ['-I', dirname(file), '-o', object, file]);
    execFileSync('arm-none-eabi-objcopy', ['-O', 'binary', '-j', '.text', object, binary]);
    return readFileSync(binary);
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Bytes of the flash from its beginning. */
export function case_image(file) {
  if (!file.endsWith('.S')) {
    const flash = new Uint8Array(flash_bytes).fill(0xff);
    let end = 0;
    read_uf2(readFileSync(file), (offset, bytes) => {
      flash.set(bytes, offset);
      end = Math.max(end, offset + bytes.length);
    });
    return flash.subarray(0, end);
  }
  const code = assemble(file);
  if (code.length > boot2_bytes) throw new Error(`${file}: ${code.length} bytes, at most ${boot2_bytes}`);
  const image = new Uint8Array(boot2_bytes + 4);
  image.set(code);
  new DataView(image.buffer).setUint32(boot2_bytes, boot2_crc(image.subarray(0, boot2_bytes)), true);
  return image;
}
