; Takes pictures with the main board's camera (PO3030K) and sends them over UART1 (115200 8N1).
;
; After a reset: the camera's identification as four hexadecimal digits and a line end. For each character
; that comes in: a picture, as BTcom's binary command I sends it: 1 (RGB565), 40, 40, then 40 rows of 40
; pixels of two bytes, the upper one first. Zoom 8 of the middle 320 x 320: the camera leaves out three
; columns and rows of four, this program every second one of the rest.
;
; Timer 5 counts VSYNC, timer 4 HREF, each edge of it 15 cycles before the first byte is read; a byte lasts
; 8 cycles. w8 is where the next byte goes, w9 the rows to come, w10 whether the picture is complete.

        .equ    BUFFER, 0x0C00
        .equ    PIXELS, 40
        .equ    CAMERA, 0xDC

        goto    main
        .org    0x003E                  ; timer 4
        .pword  line
        .org    0x0040                  ; timer 5
        .pword  frame

        .org    0x100
main:   mov     #0x2000, w15
        mov     #0x27F0, w0
        mov     w0, SPLIM
        clr     TBLPAG
        bclr    LATC, #13               ; the camera's reset
        bclr    TRISC, #13
        mov     #7, w0                  ; UART1
        mov     w0, U1BRG
        bset    U1MODE, #15
        bset    U1STA, #10
        mov     #150, w0                ; I2C, 90 kHz
        mov     w0, I2CBRG
        bset    I2CCON, #15
        mov     #0x4664, w0             ; timers 4 and 5: priority 6
        mov     w0, IPC5
        mov     #1000, w0
        rcall   delay
        bset    LATC, #13
        mov     #1000, w0
        rcall   delay

        clr     w1                      ; identification
        rcall   identify
        mov     #1, w1
        rcall   identify
        mov     #0x0D, w0
        rcall   send
        mov     #0x0A, w0
        rcall   send

        mov     #settings, w5           ; the camera's registers
        mov     #settings_end, w6
set:    tblrdl  [w5++], w2
        lsr     w2, #8, w1
        rcall   write
        cp      w5, w6
        bra     nz, set

wait:   btsc    U1STA, #1               ; too many characters at once
        bclr    U1STA, #1
        btss    U1STA, #0
        bra     wait
        mov     U1RXREG, w0
        rcall   take
        mov     #1, w0
        rcall   send
        mov     #PIXELS, w0
        rcall   send
        mov     #PIXELS, w0
        rcall   send
        mov     #BUFFER, w5
        mov     #(BUFFER + 2 * PIXELS * PIXELS), w6
next:   mov.b   [w5++], w0
        rcall   send
        cp      w5, w6
        bra     nz, next
        bra     wait

; A whole picture into the buffer.
take:   mov     #BUFFER, w8
        mov     #PIXELS, w9
        clr     w10
        mov     #2, w0                  ; external clock, off
        mov     w0, T4CON
        mov     w0, T5CON
        mov     w0, PR4                 ; every second row
        mov     #1, w0
        mov     w0, TMR4
        mov     w0, PR5
        clr     TMR5
        bclr    IFS1, #5
        bclr    IFS1, #6
        bset    IEC1, #5
        bset    IEC1, #6
        bset    T5CON, #15
taking: cp0     w10
        bra     z, taking
        return

frame:  bclr    IFS1, #6                ; a frame begins
        bset    T4CON, #15
        bclr    T5CON, #15
        retfie

line:   bclr    IFS1, #5                ; a row begins; 5 cycles behind its edge
        clr     TMR4
        mov     #PIXELS, w1
        repeat  #5
        nop
pixel:  mov     PORTD, w0               ; 15
        lsr     w0, #8, w0
        mov.b   w0, [w8++]
        repeat  #3
        nop
        mov     PORTD, w0               ; 23
        lsr     w0, #8, w0
        mov.b   w0, [w8++]
        repeat  #16
        nop
        dec     w1, w1
        bra     nz, pixel               ; 32 cycles a pixel
        dec     w9, w9
        bra     nz, row
        bclr    T4CON, #15
        mov     #1, w10
row:    retfie

; Register w1 of the camera: w2 into it, or its value as two hexadecimal digits to UART1.
write:  rcall   start
        mov     #CAMERA, w0
        rcall   out
        mov     w1, w0
        rcall   out
        mov     w2, w0
        rcall   out
        bra     stop

identify:
        rcall   start
        mov     #CAMERA, w0
        rcall   out
        mov     w1, w0
        rcall   out
        bset    I2CCON, #1              ; repeated start
again:  btsc    I2CCON, #1
        bra     again
        mov     #(CAMERA + 1), w0
        rcall   out
        bset    I2CCON, #3
in:     btsc    I2CCON, #3
        bra     in
        mov     I2CRCV, w2
        bset    I2CCON, #5              ; no more, please
        bset    I2CCON, #4
nack:   btsc    I2CCON, #4
        bra     nack
        rcall   stop
        lsr     w2, #4, w0
        rcall   digit
        mov     w2, w0
digit:  and     w0, #15, w0
        mov     #10, w3
        cp      w0, w3
        bra     ltu, small
        add     w0, #7, w0
small:  mov     #0x30, w3
        add     w0, w3, w0
send:   btsc    U1STA, #9
        bra     send
        mov     w0, U1TXREG
        return

start:  bset    I2CCON, #0
started:
        btsc    I2CCON, #0
        bra     started
        return
stop:   bset    I2CCON, #2
stopped:
        btsc    I2CCON, #2
        bra     stopped
        return
out:    mov     w0, I2CTRN
sent:   btsc    I2CSTAT, #14
        bra     sent
        return

delay:  dec     w0, w0
        bra     nz, delay
        return

; Register in the upper byte, value in the lower one.
settings:
        .pword  0x0603                  ; frame height, as wide
        .pword  0x0753
        .pword  0x0801                  ; HREF from column 366 ...
        .pword  0x096D
        .pword  0x0C03                  ; ... to 851
        .pword  0x0D53
        .pword  0x0A00                  ; rows 83 to 487
        .pword  0x0B53
        .pword  0x0E01
        .pword  0x0FE8
        .pword  0xA500                  ; VSYNC one row ahead of the first that is taken
        .pword  0xA653
        .pword  0xA701
        .pword  0xA8E7
        .pword  0xA901                  ; and one pixel behind its HREF
        .pword  0xAA6F
        .pword  0x1D20                  ; a quarter of the master clock
        .pword  0x1ECA                  ; the board carries it the other way up
        .pword  0x2033                  ; a quarter of the pixels
        .pword  0x4E08                  ; RGB565
settings_end:
        nop
