@ Alarms that are set in different places of a microsecond: GPIO2 toggles in the handler's first
@ instruction, 15 cycles after the beginning of the alarm's microsecond.
.equ BLOCKS, 1 << 5 | 1 << 8 | 1 << 21
.equ FUNC2, 5
.equ FUNC3, 31
.equ FUNC4, 31
.equ FUNC5, 31
.equ PINS, 1 << 2
.include "start.inc"
  ldr r0, =0x4005802c       @ WATCHDOG_TICK
  ldr r1, =0x200 | 12
  str r1, [r0]
  ldr r5, =0xe000ed08       @ VTOR
  ldr r0, =0x20000000
  str r0, [r5]
  adr r1, handler
  adds r1, #1
  str r1, [r0, #4 * 16]     @ TIMER_IRQ_0
  ldr r5, =0xe000e100       @ NVIC_ISER
  movs r1, #1
  str r1, [r5]
  ldr r4, =0x40054000       @ TIMER
  str r1, [r4, #0x38]       @ INTE
  movs r5, #0
  ldr r0, [r4, #0x28]
  adds r0, #5
  str r0, [r4, #0x10]       @ ALARM0
1:wfi
  b 1b
.balign 4
handler:
  str r6, [r7, #0x1c]       @ GPIO_OUT_XOR
  movs r1, #1
  str r1, [r4, #0x34]       @ INTR
  adds r5, #2
  subs r2, r5, #1
2:subs r2, #1
  bne 2b
  ldr r0, [r4, #0x28]       @ TIMERAWL
  adds r0, #3
  str r0, [r4, #0x10]       @ ALARM0
  bx lr
