// The four alarms of TIMER. GPIO 2 to 5: alarms 0 to 3, a pulse each time; alarms 0 to 2 set
// themselves again 50, 100 and 150 us later, alarm 3 does not; alarm 0 does so 3 cycles later each
// time, so at every phase of a microsecond. GPIO 6 rises when TIMERAWL is read as T, alarm 0 is set to
// T + 10 us, alarm 1 to T + 20, alarm 2 to T + 21, alarm 3 to T + 43; in every round the offsets differ
// by more than the time of a handler.
#include "tests/chip_images/start.inc"

  .equ ALARM0, 0x10
  .equ ARMED, 0x20
  .equ TIMERAWL, 0x28
  .equ INTR, 0x34
  .equ INTE, 0x38

  .macro handler number, again
  function irq\number
  ldr r0, =SIO                   // 2
  movs r1, #4 << \number         // 1
  str r1, [r0, #GPIO_SET]        // 1
  str r1, [r0, #GPIO_CLEAR]
  ldr r0, =TIMER
  movs r1, #1 << \number
  str r1, [r0, #INTR]
  .if \number == 0
  movs r0, #63
  adds r5, #1                    // only the handler uses r5
  ands r5, r0
  adds r2, r5, #1
9: subs r2, #1                   // 3 each turn: 1 to 64
  bne 9b
  ldr r0, =TIMER
  .endif
  .if \again
  ldr r1, [r0, #ALARM0 + 4 * \number]
  adds r1, #\again
  str r1, [r0, #ALARM0 + 4 * \number]
  .endif
  bx lr
  .ltorg
  .endm
  handler 0, 50
  handler 1, 100
  handler 2, 150
  handler 3, 0

  function main
  start
  .irp gpio, 2, 3, 4, 5, 6
  make_output \gpio
  .endr
  ldr r0, =NVIC_ISER
  movs r1, #15
  str r1, [r0]
  ldr r0, =TIMER
  str r1, [r0, #INTE]
  ldr r3, =SIO
  ldr r1, [r0, #TIMERAWL]
  adds r1, #10                   // T
  movs r4, #1 << 6
1: ldr r2, [r0, #TIMERAWL]       // 4
  cmp r2, r1                     // 1
  bne 1b                         // 2, or 1 at the end
  str r4, [r3, #GPIO_SET]        // 1: GPIO 6 rises
  adds r1, #10
  str r1, [r0, #ALARM0]
  adds r1, #10
  str r1, [r0, #ALARM0 + 4]
  adds r1, #1
  str r1, [r0, #ALARM0 + 8]
  adds r1, #22
  str r1, [r0, #ALARM0 + 12]
  // A store to ARMED disarms: alarm 3 would fire at T + 43, and is set again for T + 63.
  movs r2, #8
  str r2, [r0, #ARMED]
  ldr r2, [r0, #ARMED]
  cmp r2, #7                     // alarms 0 to 2
  bne 2f
  adds r1, #20
  str r1, [r0, #ALARM0 + 12]
2: b 2b
  .ltorg
