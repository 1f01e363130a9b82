@ A state machine (GPIO5) that follows a pin that the CPU drives (GPIO4), and one that toggles
@ GPIO2 every 3 clocks beside it.
.equ BLOCKS, 1 << 5 | 1 << 8 | 1 << 10
.equ FUNC2, 6
.equ FUNC3, 31
.equ FUNC4, 5
.equ FUNC5, 6
.equ PINS, 1 << 4
.include "start.inc"
  ldr r0, =0x4001c014       @ PADS_BANK0 GPIO4
  movs r1, #0x56            @ as it is after reset (2.19.6.3); in rp2040js the input is off
  str r1, [r0]
  ldr r5, =0x50200000       @ PIO0
  adr r4, program
  movs r3, #0
1:adds r2, r5, r3
  ldrh r1, [r4]
  str r1, [r2, #0x48]       @ INSTR_MEM
  adds r4, #2
  adds r3, #4
  cmp r3, #24
  bne 1b
  adds r5, #0xc8            @ SM0_CLKDIV
  ldr r1, =3 << 7 | 0 << 12 | 3 << 12
  str r1, [r5, #4]          @ SM0_EXECCTRL: wrap from 3 to 3, begins at 0
  ldr r1, =1 << 26 | 5 << 5
  str r1, [r5, #0x14]       @ SM0_PINCTRL
  ldr r2, =0xe081           @ set pindirs, 1
  str r2, [r5, #0x10]       @ SM0_INSTR
  ldr r1, =4 << 7 | 5 << 12
  str r1, [r5, #0x1c]       @ SM1_EXECCTRL
  ldr r1, =1 << 26 | 2 << 5
  str r1, [r5, #0x2c]       @ SM1_PINCTRL
  str r2, [r5, #0x28]
  movs r1, #4
  str r1, [r5, #0x28]       @ jmp 4
  subs r5, #0xc8
  movs r1, #3
  str r1, [r5]              @ CTRL: both
  movs r6, #16
  nop
  nop
  nop
  str r6, [r7, #0x1c]       @ GPIO4
1:b 1b
.balign 4
program:
  .hword 0x2084             @ wait 1 gpio 4
  .hword 0xe001             @ set pins, 1
  .hword 0xe000             @ set pins, 0
  .hword 0xa042             @ nop
  .hword 0xe201             @ set pins, 1 [2]
  .hword 0xe200             @ set pins, 0 [2]
