@ A state machine with a divider of 2.5 toggles GPIO2 with each of its instructions.
.equ BLOCKS, 1 << 5 | 1 << 8 | 1 << 10
.equ FUNC2, 6
.equ FUNC3, 31
.equ FUNC4, 31
.equ FUNC5, 31
.equ PINS, 0
.include "start.inc"
  ldr r5, =0x50200000       @ PIO0
  ldr r0, =0xe001           @ set pins, 1
  str r0, [r5, #0x48]       @ INSTR_MEM0
  subs r0, #1               @ set pins, 0
  str r0, [r5, #0x4c]
  movs r4, r5
  adds r5, #0xc8            @ SM0_CLKDIV
  ldr r1, =2 << 16 | 128 << 8
  str r1, [r5]
  ldr r1, =1 << 12
  str r1, [r5, #4]          @ SM0_EXECCTRL: wrap from 1 to 0
  ldr r1, =1 << 26 | 2 << 5
  str r1, [r5, #0x14]       @ SM0_PINCTRL
  ldr r1, =0xe081           @ set pindirs, 1
  str r1, [r5, #0x10]       @ SM0_INSTR
  movs r1, #1
  str r1, [r4]              @ CTRL
1:b 1b
