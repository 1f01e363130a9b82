@ DMA copies 1000 words while the CPU counts turns of 8 cycles until it is no longer busy; GPIO2 is
@ high for as many turns afterwards, each of 3 cycles.
.equ BLOCKS, 1 << 2 | 1 << 5 | 1 << 8
.equ FUNC2, 5
.equ FUNC3, 31
.equ FUNC4, 31
.equ FUNC5, 31
.equ PINS, 1 << 2
.include "start.inc"
  ldr r0, =0x50000000
  ldr r5, =0x20000000
  str r5, [r0]              @ READ_ADDR
  ldr r1, =0x20010000
  str r1, [r0, #4]          @ WRITE_ADDR
  ldr r1, =1000
  str r1, [r0, #8]          @ TRANS_COUNT
  ldr r1, =0x3f << 15 | 1 << 5 | 1 << 4 | 2 << 2 | 1
  ldr r4, =1 << 24
  movs r3, #0
  str r1, [r0, #12]         @ CTRL: not paced
1:adds r3, #1               @ 1
  nop
  nop
  ldr r1, [r0, #12]         @ 2 each turn
  tst r1, r4                @ 1
  bne 1b                    @ 2
  str r6, [r7, #0x1c]       @ GPIO_OUT_XOR
1:subs r3, #1
  bne 1b
  str r6, [r7, #0x1c]
1:b 1b
