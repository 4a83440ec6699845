; The range-and-bearing board's chip (dsPIC33FJ) on a CAN bus: answers each frame of robot n (can.s) on ECAN1,
; identifier 0x200 + n, with the complement of its two bytes.
;
; 122.55 kbit/s: the crystal's 4 MHz by the PLL as it is after a reset make FCY = 12.5 MHz, FCAN twice that;
; 17 quanta of 12 clocks, sampled after 13 of them. Message buffers lie at 0x7800 in DMA RAM: 0 is sent, 9
; received. Registers that share an address have no names here.

        .equ    WINDOW, 0x0420          ; C1RXFUL1, and C1BUFPNT1 in the other window
        .equ    C1TR01, 0x0430
        .equ    SEND, 0x7800
        .equ    TAKEN, 0x7890

        goto    main

        .org    0x200
main:   mov     #0x0900, w15
        mov     #0x1FF0, w0
        mov     w0, SPLIM

        mov     #0x0400, w0             ; configuration mode, FCAN = 2 FCY
        mov     w0, C1CTRL1
        mov     #0x0045, w0             ; jumps of 2 quanta
        mov     w0, C1CFG1
        mov     #0x03AD, w0             ; 1 + 6 + 6 + 4 quanta
        mov     w0, C1CFG2
        mov     #0x8000, w0             ; 16 buffers
        mov     w0, C1FCTRL
        mov     #0x0401, w0             ; window of filters: filter 0 takes all, to buffer 9
        mov     w0, C1CTRL1
        mov     #9, w0
        mov     w0, WINDOW
        clr     0x0430
        clr     0x0432
        clr     0x0440
        clr     0x0442
        clr     0x0418
        mov     #1, w0
        mov     w0, 0x0414
        mov     #0x0400, w0
        mov     w0, C1CTRL1
        mov     #70, w0                 ; DMA 0 to C1TXD
        mov     w0, DMA0REQ
        mov     #0x0442, w0
        mov     w0, DMA0PAD
        mov     #7, w0
        mov     w0, DMA0CNT
        mov     #0xA020, w0
        mov     w0, DMA0CON
        mov     #34, w0                 ; DMA 1 from C1RXD
        mov     w0, DMA1REQ
        mov     #0x0440, w0
        mov     w0, DMA1PAD
        mov     #7, w0
        mov     w0, DMA1CNT
        mov     #0x8020, w0
        mov     w0, DMA1CON
        mov     #0x0080, w0             ; buffer 0 is for sending
        mov     w0, C1TR01
        clr     w0                      ; normal mode
        mov     w0, C1CTRL1
normal: mov     C1CTRL1, w0
        and     #0xE0, w0
        bra     nz, normal

loop:   btss    WINDOW, #9
        bra     loop
        mov     TAKEN, w0               ; 0x100 + n, one place further left than the identifier
        lsr     w0, #2, w0
        and     w0, #15, w0
        mov     #0x0200, w1
        ior     w0, w1, w0
        sl      w0, #2, w0
        mov     w0, SEND
        clr     w0
        mov     w0, SEND + 2
        mov     #2, w0
        mov     w0, SEND + 4
        mov     TAKEN + 6, w0
        com     w0, w0
        mov     w0, SEND + 6
        mov     #0xFDFF, w0             ; buffer 9 may take the next
        mov     w0, WINDOW
        mov     #0x0088, w0
        mov     w0, C1TR01
        bra     loop

        .org    0xF80006
        .pword  0x00FFFB                ; primary oscillator with PLL
        .pword  0x00FF7D
        .pword  0x00FF7F
