; Robots on a CAN bus: each says its selector's position every 10 ms on CAN1, and toggles LED n for each frame
; from robot n.
;
; 122.88 kbit/s: FCAN = FCY = 14.7456 MHz, 15 quanta of 8 cycles, sampled after 11 of them. Identifier 0x100 +
; position, two bytes: position, count. w8 is the position, w9 the count.

        goto    main

        .org    0x200
main:   mov     #0x2000, w15
        mov     #0x27F0, w0
        mov     w0, SPLIM
        clr     LATA
        mov     #0x093F, w0             ; LEDs
        mov     w0, TRISA
        mov     PORTG, w0               ; selector
        lsr     w0, #6, w0
        and     w0, #15, w8
        clr     w9

        mov     #0x0C00, w0             ; configuration mode, FCAN = FCY
        mov     w0, C1CTRL
        mov     #0x0043, w0             ; jumps of 2 quanta
        mov     w0, C1CFG1
        mov     #0x03A4, w0             ; 1 + 5 + 5 + 4 quanta
        mov     w0, C1CFG2
        clr     C1RXM0SID               ; both buffers take everything
        clr     C1RXM0EIDH
        clr     C1RXM0EIDL
        clr     C1RXM1SID
        clr     C1RXM1EIDH
        clr     C1RXM1EIDL
        mov     #0x0004, w0             ; what buffer 0 cannot take goes to buffer 1
        mov     w0, C1RX0CON
        mov     #0x0800, w0             ; normal mode
        mov     w0, C1CTRL
normal: mov     C1CTRL, w0
        and     #0xE0, w0
        bra     nz, normal

        mov     #18431, w0              ; timer 1: 10 ms
        mov     w0, PR1
        mov     #0x8010, w0
        mov     w0, T1CON

loop:   btss    C1RX0CON, #7
        bra     other
        mov     C1RX0B1, w0
        bclr    C1RX0CON, #7
        rcall   heard
other:  btss    C1RX1CON, #7
        bra     tick
        mov     C1RX1B1, w0
        bclr    C1RX1CON, #7
        rcall   heard
tick:   btss    IFS0, #3
        bra     loop
        bclr    IFS0, #3
        btsc    C1TX0CON, #3            ; the last one still waits
        bra     loop
        sl      w8, #2, w0
        mov     #0x2000, w1
        ior     w0, w1, w0
        mov     w0, C1TX0SID
        clr     C1TX0EID
        mov     #0x0010, w0
        mov     w0, C1TX0DLC
        sl      w9, #8, w0
        ior     w0, w8, w0
        mov     w0, C1TX0B1
        inc     w9, w9
        bset    C1TX0CON, #3
        bra     loop

heard:  and     w0, #7, w0
        sl      w0, #1, w0
        bra     w0
        btg     LATA, #6
        return
        btg     LATA, #7
        return
        btg     LATA, #9
        return
        btg     LATA, #12
        return
        btg     LATA, #10
        return
        btg     LATA, #13
        return
        btg     LATA, #14
        return
        btg     LATA, #15
        return
