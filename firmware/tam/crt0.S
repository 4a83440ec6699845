; Reset, interrupt vectors, and memory as C expects it.

        .section .vectors, "ax", @progbits
        .global __vectors
__vectors:
        jmp     reset                   ; 0
        .rept 8
        jmp     unexpected              ; 1..8
        .endr
        jmp     __vector_9          ; 9 TIMER2_COMPA
        .rept 2
        jmp     unexpected              ; 10..11
        .endr
        jmp     __vector_12          ; 12 TIMER1_CAPT
        .rept 3
        jmp     unexpected              ; 13..15
        .endr
        jmp     __vector_16          ; 16 TIMER0_COMPA
        .rept 3
        jmp     unexpected              ; 17..19
        .endr
        jmp     __vector_20        ; 20 USART0_RX
        jmp     __vector_21        ; 21 USART0_UDRE
        .rept 6
        jmp     unexpected              ; 22..27
        .endr
        jmp     __vector_28          ; 28 USART1_RX
        jmp     __vector_29          ; 29 USART1_UDRE
        .rept 5
        jmp     unexpected              ; 30..34
        .endr

        .text
; No interrupt without a routine is ever enabled: start over.
unexpected:
reset:
        clr     r1                      ; what the compiler takes for zero
        out     0x3F, r1                ; SREG
        ldi     r28, lo8(__stack)
        ldi     r29, hi8(__stack)
        out     0x3D, r28
        out     0x3E, r29
        ; .data from flash; it lies below 64 KB
        ldi     r26, lo8(__data_start)
        ldi     r27, hi8(__data_start)
        ldi     r30, lo8(__data_load)
        ldi     r31, hi8(__data_load)
        ldi     r18, hi8(__data_end)
        rjmp    2f
1:      lpm     r0, Z+
        st      X+, r0
2:      cpi     r26, lo8(__data_end)
        cpc     r27, r18
        brne    1b
        ; .bss
        ldi     r26, lo8(__bss_start)
        ldi     r27, hi8(__bss_start)
        ldi     r18, hi8(__bss_end)
        rjmp    4f
3:      st      X+, r1
4:      cpi     r26, lo8(__bss_end)
        cpc     r27, r18
        brne    3b
        call    main
        rjmp    reset

; The compiler asks for these by name; the code above does their work.
        .global __do_copy_data, __do_clear_bss
        .set    __do_copy_data, 0
        .set    __do_clear_bss, 0
