@ A pended interrupt: GPIO2 toggles before, in the handler's first instruction, and after the return.
.equ BLOCKS, 1 << 5 | 1 << 8
.equ FUNC2, 5
.equ FUNC3, 31
.equ FUNC4, 31
.equ FUNC5, 31
.equ PINS, 1 << 2
.include "start.inc"
  ldr r5, =0xe000ed08       @ VTOR
  ldr r0, =0x20000000
  str r0, [r5]
  adr r1, handler
  adds r1, #1
  adds r0, #4 * (16 + 26)   @ a line without a block
  str r1, [r0]
  ldr r5, =0xe000e100       @ NVIC_ISER
  ldr r4, =0xe000e200       @ NVIC_ISPR
  ldr r0, =1 << 26
  str r0, [r5]
  str r6, [r7, #0x1c]       @ GPIO_OUT_XOR
  str r0, [r4]
  str r6, [r7, #0x1c]
1:b 1b
.balign 4
handler:
  str r6, [r7, #0x1c]
  bx lr
