@ Sleeps; an alarm every 1000 us.
.equ BLOCKS, 1 << 5 | 1 << 8 | 1 << 21
.include "start.inc"
  cpsid i
  ldr r4, =0x40054000       @ TIMER
  ldr r5, =0xe000e100       @ NVIC_ISER
  movs r6, #1
  str r6, [r5]
  str r6, [r4, #0x38]       @ INTE
  adds r5, #0xff            @ NVIC_ICPR is 0x180 above ISER
  adds r5, #0x81
  ldr r3, =1000
next:
  ldr r0, [r4, #0x28]       @ TIMERAWL
  adds r0, r3
  str r0, [r4, #0x10]       @ ALARM0
  wfi
  str r6, [r4, #0x34]       @ INTR
  str r6, [r5]
  b next
