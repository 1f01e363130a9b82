@ Cycles of instructions: GPIO2 toggles around each of them, so that edges are 1 + its cycles apart.
.equ BLOCKS, 1 << 5 | 1 << 8 | 1 << 10 | 1 << 21
.equ FUNC2, 5
.equ FUNC3, 31
.equ FUNC4, 31
.equ FUNC5, 31
.equ PINS, 1 << 2
.include "start.inc"
  ldr r5, =0x20000000
  ldr r4, =0x40054000       @ TIMER, on APB
  ldr r3, =0x50200000       @ PIO0, on AHB-Lite
  str r6, [r7, #0x1c]       @ GPIO_OUT_XOR
  str r6, [r7, #0x1c]
  nop
  str r6, [r7, #0x1c]
  ldr r0, [r5]
  str r6, [r7, #0x1c]
  str r0, [r5]
  str r6, [r7, #0x1c]
  ldr r0, [r7, #4]          @ GPIO_IN
  str r6, [r7, #0x1c]
  ldr r0, [r4, #0x28]       @ TIMERAWL
  str r6, [r7, #0x1c]
  str r0, [r4, #0x3c]       @ INTF
  str r6, [r7, #0x1c]
  ldr r0, [r3, #4]          @ FSTAT
  str r6, [r7, #0x1c]
  str r0, [r3, #8]          @ FDEBUG
  str r6, [r7, #0x1c]
  b 1f
1:str r6, [r7, #0x1c]
  cmp r7, r7
  bne 1f
  str r6, [r7, #0x1c]
1:muls r0, r0, r0
  str r6, [r7, #0x1c]
  bl function
  str r6, [r7, #0x1c]
  ldmia r5!, {r0-r2}
  str r6, [r7, #0x1c]
  push {r0, r1}
  pop {r0, r1}
  str r6, [r7, #0x1c]
  mrs r0, primask
  str r6, [r7, #0x1c]
1:b 1b
function:
  bx lr
