// Interrupts of two priorities, pended by software and by SysTick: preemption, tail-chaining, late
// arrival. Each handler has a pin: GPIO 3 low priority (IRQ 26), GPIO 4 low priority (IRQ 27), GPIO 5
// high priority (IRQ 28), GPIO 6 high priority (SysTick). GPIO 2 is the main program's; it is high
// during the stores of r4 to r7.
#include "tests/chip_images/start.inc"

  .equ SYST_RVR, 4
  .equ SYST_CVR, 8

  .macro rise gpio               // 2 + 1, and the store of 1
  ldr r0, =SIO
  movs r1, #1 << \gpio
  str r1, [r0, #GPIO_SET]
  .endm
  .macro fall
  str r1, [r0, #GPIO_CLEAR]
  .endm
  .macro pend irq                // 2 + 2, and the store of 2
  ldr r2, =NVIC_ISPR
  ldr r3, =1 << \irq
  str r3, [r2]
  .endm

// Low: pends the other low one and the high one while it runs, if r7 is set.
  function irq26
  rise 3
  cmp r7, #0                     // 1
  beq 1f                         // 1 or 2
  pend 27
  pend 28
  nop
1: fall
  bx lr
  function irq27
  rise 4
  fall
  bx lr
  function irq28
  rise 5
  fall
  bx lr
  .ltorg
  function systick
  rise 6
  fall
  ldr r0, =SYST_CSR
  movs r1, #0
  str r1, [r0]
  bx lr
  .ltorg

// SysTick counts from now on and interrupts in `cycles` cycles: a write clears it; it loads the reload
// value in the next cycle and requests its interrupt when it reaches 0.
  .macro systick_in cycles
  ldr r2, =SYST_CSR
  ldr r3, =\cycles - 1
  str r3, [r2, #SYST_RVR]
  movs r3, #0
  str r3, [r2, #SYST_CVR]
  movs r3, #7
  .endm

  .macro pause
  movs r0, #100
9: subs r0, #1
  bne 9b
  .endm

// Pends interrupts, bits from 26 on; `pends` says whether IRQ 26 pends others.
  .macro round interrupts, pends
  movs r7, #\pends
  ldr r2, =NVIC_ISPR
  ldr r3, =\interrupts << 26
  str r5, [r4, #GPIO_SET]
  str r3, [r2]
  str r5, [r4, #GPIO_CLEAR]
  pause
  .endm

  function main
  start
  .irp gpio, 2, 3, 4, 5, 6
  make_output \gpio
  .endr
  ldr r0, =NVIC_IPR + 24         // IRQ 24 to 27: 26, 27 priority 2
  ldr r1, =0x80800000
  str r1, [r0]
  ldr r0, =NVIC_IPR + 28         // IRQ 28: priority 1
  movs r1, #0x40
  str r1, [r0]
  ldr r0, =SHPR3                 // SysTick: priority 0
  movs r1, #0
  str r1, [r0]
  ldr r0, =NVIC_ISER
  ldr r1, =7 << 26
  str r1, [r0]
  ldr r4, =SIO
  movs r5, #1 << 2

  round 1, 0    // 1: a single interrupt
  round 1, 1    // 2: it pends an equal and a higher one
  round 3, 0    // 3: two at once
  // 4: a low one, and SysTick while its registers are being saved.
  ldr r1, =NVIC_ISPR
  ldr r6, =1 << 26
  systick_in 10
  movs r0, #0
  str r3, [r2]                   // 2
  str r0, [r2, #SYST_RVR]        // 2: once only, a reload value of 0 stops it
  str r5, [r4, #GPIO_SET]        // 1
  str r6, [r1]                   // 2
  str r5, [r4, #GPIO_CLEAR]
  pause
  // 5: masked, pended, unmasked.
  cpsid i
  str r6, [r1]
  nop
  nop
  str r5, [r4, #GPIO_SET]
  cpsie i
  str r5, [r4, #GPIO_CLEAR]
1: b 1b
  .ltorg
