// Flash as memory. GPIO 2: high for a store (1) and a load from flash that is not in the cache, for the
// same load again, for two loads past the cache, for a load after a flush. GPIO 3: a loop that runs in
// flash.
#include "tests/chip_images/start.inc"

  .equ CACHED, 0x10080000        // erased, after the image
  .equ UNCACHED, 0x13080000
  .equ XIP_FLUSH, 0x14000004

  .macro load address
  ldr r6, =\address
  str r5, [r4, #GPIO_SET]
  ldr r1, [r6]
  str r5, [r4, #GPIO_CLEAR]
  movs r0, #100
9: subs r0, #1
  bne 9b
  .endm

  function main
  start
  make_output 2
  make_output 3
  ldr r4, =SIO
  movs r5, #1 << 2
  load CACHED
  load CACHED
  load UNCACHED
  load UNCACHED
  ldr r6, =XIP_FLUSH
  movs r1, #1
  str r1, [r6]
  ldr r1, [r6]                   // until it is done (2.6.3.2)
  load CACHED
  load CACHED
  ldr r0, =in_flash
  bx r0
  .ltorg

  .section .loader.text, "ax", %progbits
  .balign 4
  .thumb_func
  .type in_flash, %function
in_flash:
  movs r1, #1 << 3
1: str r1, [r4, #GPIO_TOGGLE]    // 1
  b 1b                           // 2
