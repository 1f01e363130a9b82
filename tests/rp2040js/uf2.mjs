// Reads a UF2 file (UF2 format specification), as the boot loader of the chip would flash it.

const block_bytes = 512;
const family_rp2040 = 0xe48bff56;
const flash_base = 0x10000000;

const flash_bytes = 2 * 1024 * 1024;

/** The resulting flash; throws at the first invalid block. */
export function read_uf2(file) {
  const flash = new Uint8Array(flash_bytes).fill(0xff);
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  const word = (at) => view.getUint32(at, true);
  if (file.length === 0 || file.length % block_bytes !== 0) throw new Error('UF2: not whole blocks');
  const count = file.length / block_bytes;
  for (let i = 0; i < count; ++i) {
    const at = i * block_bytes;
    const start = word(at) === 0x0a324655 && word(at + 4) === 0x9e5d5157;
    if (!start || word(at + 508) !== 0x0ab16f30) throw new Error(`UF2: block ${i} has no frame`);
    if (word(at + 28) !== family_rp2040) throw new Error(`UF2: block ${i} is of another chip`);
    if (word(at + 20) !== i || word(at + 24) !== count) throw new Error(`UF2: block ${i} misplaced`);
    flash.set(file.subarray(at + 32, at + 32 + word(at + 16)), word(at + 12) - flash_base);
  }
  return flash;
}
