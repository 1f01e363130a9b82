// One interrupt that polls an input and makes steps on three pins, as fast as it can: TIMER holds
// its request (INTF), so that each return chains to the next entry.
//
// GPIO 2, 3, 4: steps of X, Y, Z at 1/2, 1/4, 3/4 of the rate of the interrupt. GPIO 5 rises at the
// start of each handler. GPIO 8 high: no steps any more; the main program then toggles GPIO 6,
// interrupted by alarm 1 every 100 us.
#include "tests/chip_images/start.inc"

  .equ TIMERAWL, 0x28
  .equ ALARM1, 0x14
  .equ INTR, 0x34
  .equ INTE, 0x38
  .equ INTF, 0x3c

// One axis: phase += rate, the carry goes into r3. 2 + 2 + 1 + 2 + 1 = 8 cycles.
  .macro axis number
  ldr r2, [r1, #8 * \number]
  ldr r0, [r1, #8 * \number + 4]
  adds r2, r0
  str r2, [r1, #8 * \number]
  adcs r3, r3
  .endm

  function irq0
  ldr r0, =SIO                   // 2
  movs r3, #1 << 5               // 1
  str r3, [r0, #GPIO_SET]        // 1: GPIO 5 rises
  str r3, [r0, #GPIO_CLEAR]      // 1: and falls
  ldr r1, =axes                  // 2
  movs r3, #0                    // 1
  axis 2                         // 8
  axis 1                         // 8
  axis 0                         // 8
  lsls r3, #2                    // 1
  ldr r0, =SIO                   // 2
  str r3, [r0, #GPIO_SET]        // 1: steps rise
  ldr r2, [r0, #GPIO_IN]         // 1
  lsls r2, #31 - 8               // 1
  bmi 1f                         // 1, not taken
  str r3, [r0, #GPIO_CLEAR]      // 1: steps fall
  bx lr                          // the next entry
1: str r3, [r0, #GPIO_CLEAR]
  ldr r0, =TIMER
  movs r1, #0
  str r1, [r0, #INTF]
  bx lr
  .ltorg

  function irq1
  ldr r0, =SIO                   // 2
  movs r3, #1 << 5               // 1
  str r3, [r0, #GPIO_SET]        // 1: GPIO 5 rises
  str r3, [r0, #GPIO_CLEAR]      // 1: and falls
  ldr r0, =TIMER                 // 2
  movs r1, #2                    // 1
  str r1, [r0, #INTR]            // 5
  ldr r1, [r0, #ALARM1]          // 4
  adds r1, #100                  // 1
  str r1, [r0, #ALARM1]          // 5
  bx lr
  .ltorg

  function main
  start
  .irp gpio, 2, 3, 4, 5, 6, 8
  make_output \gpio
  .endr
  ldr r0, =SIO
  ldr r1, =1 << 8
  str r1, [r0, #0x28]            // GPIO_OE_CLR: GPIO 8 is an input
  ldr r0, =NVIC_ISER
  movs r1, #3
  str r1, [r0]
  ldr r0, =TIMER
  movs r1, #1
  str r1, [r0, #INTF]
  nop
  // Not reached before GPIO 8 is high.
  movs r1, #2
  str r1, [r0, #INTE]
  ldr r1, [r0, #TIMERAWL]
  adds r1, #100
  str r1, [r0, #ALARM1]
  ldr r0, =SIO
  movs r1, #1 << 6
toggle:
  str r1, [r0, #GPIO_TOGGLE]     // 1
  b toggle                       // 2
  .ltorg

  .section .data
  .balign 4
axes:                            // phase, rate in steps an interrupt with 32 bits of fraction
  .word 0, 0x80000000
  .word 0, 0x40000000
  .word 0, 0xc0000000
