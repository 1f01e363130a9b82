// A loop that toggles a pin, and single instructions between two edges of a pin, which show their
// cycles. GPIO 2: the instructions, in the order of sio_toggle.script; GPIO 3: the loop.
#include "tests/chip_images/start.inc"

// High for 1 cycle (the store of the rising edge) plus the cycles of the instructions. r4 is SIO, r5
// the pin; r6 is an address in SRAM, r7 a register on the APB or on the AHB-Lite.
  .macro between instructions
  str r5, [r4, #GPIO_SET]
  \instructions
  str r5, [r4, #GPIO_CLEAR]
  movs r0, #5
9: subs r0, #1
  bne 9b
  .endm

  function main
  start
  ldr r0, =RESETS_CLEAR
  ldr r1, =1 << 10
  str r1, [r0]
  ldr r0, =RESETS
1: ldr r2, [r0, #RESET_DONE]
  tst r2, r1
  beq 1b
  make_output 2
  make_output 3
  ldr r4, =SIO
  movs r5, #1 << 2
  ldr r6, =place
  ldr r7, =TIMER + 0x38  // INTE

  between ""
  between "nop"
  between "nop; nop; nop"
  between "adds r1, r1, #1"
  between "muls r1, r2"
  between "ldr r1, [r6]"
  between "str r1, [r6]"
  between "ldrb r1, [r6]"
  between "strh r1, [r6]"
  between "push {r1-r3}"
  between "pop {r1-r3}"
  mov r1, r6
  between "stm r1!, {r2, r3}"
  mov r1, r6
  between "ldm r1, {r0-r3}"
  between "ldr r1, [r4, #GPIO_IN]"
  between "b 1f; 1:"
  movs r1, #0
  cmp r1, #0
  between "bne 1f; 1:"
  movs r1, #0
  cmp r1, #0
  between "beq 1f; 1:"
  adr r1, 2f
  adds r1, #1
  between "bx r1; .balign 4; 2:"
  between "bl nothing"
  ldr r1, =nothing
  between "blx r1"
  movs r1, #0
  between "add pc, r1; nop"
  between "dmb"
  between "dsb"
  between "isb"
  between "mrs r1, primask"
  between "msr primask, r1"
  between "cpsid i"
  between "cpsie i"
  between "ldr r1, [r7]"
  between "str r1, [r7]"
  ldr r7, =PIO0
  between "ldr r1, [r7, #4]"  // FSTAT
  between "str r1, [r7, #8]"  // FDEBUG

  ldr r0, =SIO
  movs r1, #1 << 3
toggle:
  str r1, [r0, #GPIO_TOGGLE]
  b toggle
  .ltorg

  .balign 4
  .thumb_func
nothing: bx lr

  .bss
  .balign 4
place: .space 16
