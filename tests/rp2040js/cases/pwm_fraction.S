@ PWM with a divider of 1.5: 10 counts of 1.5 clocks, high for 3 of them. The counter begins at 5,
@ so that the first edge is that of a wrap.
.equ BLOCKS, 1 << 5 | 1 << 8 | 1 << 14
.equ FUNC2, 4
.equ FUNC3, 31
.equ FUNC4, 31
.equ FUNC5, 31
.equ PINS, 0
.include "start.inc"
  ldr r0, =0x40050014       @ CH1_CSR
  movs r1, #0x18
  str r1, [r0, #4]          @ DIV
  movs r1, #5
  str r1, [r0, #8]          @ CTR
  movs r1, #3
  str r1, [r0, #0xc]        @ CC
  movs r1, #9
  str r1, [r0, #0x10]       @ TOP
  movs r1, #1
  str r1, [r0]
1:b 1b
