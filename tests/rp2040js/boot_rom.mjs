// The parts of the boot ROM that an image needs, by own code: the table of functions at 0x14, its
// lookup function at 0x18 (RP2040 datasheet, 2.8.3), and the flash functions on an array of bytes.
//
// Every function is a break point with its number, then a return; the number selects the action.

const rom_bytes = 16 * 1024;
const table_at = 0x100;
const lookup_at = 0x200;
const functions_at = 0x240;

// lookup(r0 = table, r1 = code): entries are code, address; code 0 ends the table.
const lookup_code = [
  0x8802,  //       ldrh r2, [r0, #0]
  0x2a00,  //       cmp  r2, #0
  0xd003,  //       beq  none
  0x428a,  //       cmp  r2, r1
  0xd003,  //       beq  found
  0x3004,  //       adds r0, #4
  0xe7f8,  //       b    lookup
  0x2000,  // none: movs r0, #0
  0x4770,  //       bx   lr
  0x8840,  // found: ldrh r0, [r0, #2]
  0x4770,  //       bx   lr
];

/** Enters the second-stage boot as the ROM does. */
export function enter_boot2(core) {
  core.SP = 0x20041f00;
  core.PC = 0x10000000;
}

/** ROM for `mcu`. `flash()` returns its flash; `boot_loader()` is called on the image's request. */
export function install_rom(mcu, boot_loader) {
  const sector = 4096;
  const page = 256;
  const refuse = (what) => { throw new Error(`ROM function called with ${what}`); };
  const functions = {
    IF() {},  // connect the flash
    EX() {},  // leave execution in place
    FC() {},  // empty the cache
    RE([at, count]) {
      if (at % sector !== 0 || count % sector !== 0) refuse(`a part of a sector: ${at}, ${count}`);
      mcu.flash.fill(0xff, at, at + count);
    },
    RP([at, from, count]) {
      if (at % page !== 0 || count % page !== 0) refuse(`a part of a page: ${at}, ${count}`);
      for (let i = 0; i < count; ++i) mcu.flash[at + i] &= mcu.readUint8(from + i);
    },
    UB() { boot_loader(); },
  };

  const names = Object.keys(functions);
  const view = new DataView(new ArrayBuffer(rom_bytes));
  view.setUint16(0x14, table_at, true);
  view.setUint16(0x18, lookup_at | 1, true);
  lookup_code.forEach((half_word, i) => view.setUint16(lookup_at + 2 * i, half_word, true));
  names.forEach((name, i) => {
    const at = functions_at + 4 * i;
    view.setUint16(table_at + 4 * i, name.charCodeAt(0) | name.charCodeAt(1) << 8, true);
    view.setUint16(table_at + 4 * i + 2, at | 1, true);
    view.setUint16(at, 0xbe00 | i, true);    // bkpt #i
    view.setUint16(at + 2, 0x4770, true);    // bx lr
  });
  mcu.loadBootrom(new Uint32Array(view.buffer));
  mcu.onBreak = (number) => {
    const name = names[number];
    if (name === undefined) throw new Error(`break point ${number} outside the ROM`);
    functions[name]([...mcu.core.registers.slice(0, 4)].map((r) => r >>> 0));
  };
}
