@ Sleeps; an alarm every 1000 us.
.equ BLOCKS, 1 << 5 | 1 << 8 | 1 << 21
.include "start.inc"
  ldr r5, =0xe000ed08       @ VTOR
  ldr r0, =0x20000000
  str r0, [r5]
  adr r1, handler
  adds r1, #1
  str r1, [r0, #4 * 16]     @ TIMER_IRQ_0
  ldr r5, =0xe000e100       @ NVIC_ISER
  movs r6, #1
  str r6, [r5]
  ldr r4, =0x40054000       @ TIMER
  str r6, [r4, #0x38]       @ INTE
  ldr r5, =1000
  bl next
1:wfi
  b 1b
.balign 4
handler:
  str r6, [r4, #0x34]       @ INTR
next:
  ldr r0, [r4, #0x28]       @ TIMERAWL
  adds r0, r5
  str r0, [r4, #0x10]       @ ALARM0
  bx lr
