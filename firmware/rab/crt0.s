; Start-up of the range-and-bearing firmware: reset vector, interrupt vectors, configuration words, stack,
; cleared RAM, window on the constants. There is no initialised data (rab.ld checks that).

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

; Every trap and every interrupt that is not used: start again.
__unexpected:
        reset

        .section .vectors, code
        .macro  unexpected_vectors count
        .rept   \count
        .pword  paddr(__unexpected)
        .endr
        .endm
        unexpected_vectors 8            ; traps
        unexpected_vectors 3            ; 0..2
        .pword  paddr(__T1Interrupt)    ; 3
        unexpected_vectors 4            ; 4..7
        .pword  paddr(__T3Interrupt)    ; 8
        unexpected_vectors 2            ; 9, 10
        .pword  paddr(__U1RXInterrupt)  ; 11
        .pword  paddr(__U1TXInterrupt)  ; 12
        .pword  paddr(__ADC1Interrupt)  ; 13
        unexpected_vectors 2            ; 14, 15
        .pword  paddr(__SI2C1Interrupt) ; 16
        unexpected_vectors 3            ; 17..19
        .pword  paddr(__INT1Interrupt)  ; 20
        unexpected_vectors 9            ; 21..29
        .pword  paddr(__U2RXInterrupt)  ; 30
        .pword  paddr(__U2TXInterrupt)  ; 31
        unexpected_vectors 86           ; 32..117

        .section .configuration, code
        .pword  0x0000CF                ; FBS: no boot segment
        .pword  0x0000CF                ; FSS: no secure segment
        .pword  0x000007                ; FGS: no protection
        .pword  0x0000A0                ; FOSCSEL: start on the internal oscillator
        .pword  0x000045                ; FOSC: crystal, clock switching on, monitor off
        .pword  0x00005F                ; FWDT: watchdog off
        .pword  0x0000E7                ; FPOR: power-up timer 128 ms
        .pword  0x0000C3                ; FICD: JTAG off, its pins reset peak detectors

        .end
