@ A loop that never sleeps: arithmetic, SRAM, branches taken and not, a call.
.equ BLOCKS, 1 << 5 | 1 << 8
.include "start.inc"
  ldr r4, =0x20000000
  movs r0, #1
  movs r3, #0
loop:
  ldr r1, [r4, #4]
  adds r1, r0
  str r1, [r4, #4]
  muls r1, r0, r1
  lsrs r2, r1, #3
  eors r3, r2
  bcs 1f
  adds r0, #1
1:ldrh r2, [r4, #8]
  adds r2, #1
  strh r2, [r4, #8]
  bl function
  b loop
function:
  push {r0, r1, r2}
  pop {r0, r1, r2}
  bx lr
