// Start of every small image, in SRAM: vector table, variables, main().
//
// The board's loader provides second-stage boot, clocks (125 MHz from the crystal) and the copy to
// SRAM. An image defines the handlers it needs by their names, irq0 to irq31, systick, pend_sv, svc,
// nmi and hard_fault; any other exception ends in `unexpected`, where the image stops.
#include "tests/chip_images/start.inc"

  function unexpected
  b unexpected

  .macro handler name
  .weak \name
  .thumb_set \name, unexpected
  .word \name
  .endm

// ARMv6-M Architecture Reference Manual, B1.5.3.
  .section .vectors, "a", %progbits
  .balign 256
vectors:
  .word stack_top, start_image
  handler nmi
  handler hard_fault
  .rept 7
  .word unexpected
  .endr
  handler svc
  .word unexpected, unexpected
  handler pend_sv
  handler systick
  .irp number, 0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28,29,30,31
  handler irq\number
  .endr

  function start_image
  ldr r0, =0xe000ed08  // VTOR
  ldr r1, =vectors
  str r1, [r0]
  ldr r0, =bss_begin
  ldr r1, =bss_end
  movs r2, #0
1: cmp r0, r1
  beq 2f
  stm r0!, {r2}
  b 1b
2: bl main
  b unexpected
  .ltorg
