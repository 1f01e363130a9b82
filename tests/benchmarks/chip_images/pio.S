@ Four machines of PIO0 toggle GPIO2 to GPIO5, one each, in every clock; the CPU sleeps.
.equ BLOCKS, 1 << 5 | 1 << 8 | 1 << 10
.include "start.inc"
  ldr r5, =0x50200000       @ PIO0
  ldr r0, =0xe001           @ set pins, 1
  str r0, [r5, #0x48]
  subs r0, #1               @ set pins, 0
  str r0, [r5, #0x4c]
  ldr r4, =0x40014014       @ GPIO2_CTRL
  ldr r2, =1 << 26 | 2 << 5
  ldr r3, =0x18
  adds r5, #0xc8            @ SM0_CLKDIV
  movs r6, #4
machine:
  movs r0, #6               @ PIO0
  str r0, [r4]
  adds r4, #8
  str r2, [r5, #0x14]       @ PINCTRL
  adds r2, #1 << 5
  ldr r0, =0xe081           @ set pindirs, 1
  str r0, [r5, #0x10]       @ INSTR
  ldr r0, =1 << 12
  str r0, [r5, #4]          @ EXECCTRL: wrap from 1 to 0
  adds r5, r3
  subs r6, #1
  bne machine
  ldr r5, =0x50200000
  movs r0, #15
  str r0, [r5]              @ CTRL
1:wfi
  b 1b
