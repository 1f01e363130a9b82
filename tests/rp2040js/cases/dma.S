@ DMA paced by its timer at 1/50 of clk_sys toggles GPIO2 by its override (2.19.6.1).
.equ BLOCKS, 1 << 2 | 1 << 5 | 1 << 8
.equ FUNC2, 5
.equ FUNC3, 31
.equ FUNC4, 31
.equ FUNC5, 31
.equ PINS, 1 << 2
.include "start.inc"
  ldr r5, =0x20000000
  ldr r1, =0x305            @ OUTOVER high
  str r1, [r5]
  ldr r1, =0x205            @ OUTOVER low
  str r1, [r5, #4]
  ldr r0, =0x50000420
  ldr r1, =1 << 16 | 50
  str r1, [r0]              @ TIMER0: 1/50
  ldr r0, =0x50000000
  str r5, [r0]              @ READ_ADDR
  ldr r1, =0x40014014
  str r1, [r0, #4]          @ WRITE_ADDR: GPIO2_CTRL
  movs r1, #8
  str r1, [r0, #8]          @ TRANS_COUNT
  ldr r1, =59 << 15 | 3 << 6 | 1 << 4 | 2 << 2 | 1
  str r1, [r0, #12]         @ CTRL: TIMER0, ring of 8 bytes, words
1:b 1b
