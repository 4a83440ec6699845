; Start-up: reset and interrupt vectors, configuration words, stack, cleared RAM, constants. Variables with an initial
; value are not provided for: set them in main().

        .section .reset, code
        goto    __reset

        .text
        .global __reset
__reset:
        mov     #__stack_start, w15
        mov     #__stack_limit, w0
        mov     w0, 0x0020              ; SPLIM
        nop
        mov     #__bss_start, w0
        mov     #__bss_words - 1, w1
        repeat  w1
        clr     [w0++]
        clr     0x0034                  ; PSVPAG: all constants lie in the first 32 KB
        bset    0x0044, #2              ; CORCON<PSV>
        rcall   _main
        reset

; Every trap and every interrupt that is not used: start again. puckloop reports which one it was.
__unexpected:
        reset

        .section .vectors, code
        .macro  unexpected_vectors count
        .rept   \count
        .pword  paddr(__unexpected)
        .endr
        .endm
        unexpected_vectors 8            ; 0..7   traps
        unexpected_vectors 3            ; 8..10
        .pword  paddr(__T1Interrupt)    ; 11
        unexpected_vectors 50           ; 12..61

        .section .configuration, code
        .pword  0xC706                  ; FOSC: crystal, PLL x8, no clock switching
        .pword  0x003F                  ; FWDT: watchdog off
        .pword  0x8733                  ; FBORPOR: MCLR on, brown-out off, power-up timer 64 ms

        .section .protection, code
        .pword  0x0007                  ; FGS: no protection

        .end
