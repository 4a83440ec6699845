#pragma once
// Programs of a main board that is an I2C slave, and master beside it.

#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace puckloop::tests {

// Asks its flag in a loop: 0x5A to whoever reads.
inline const std::string kPolling = R"(
        .org 0x200
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        mov #0x1f, w0
        mov w0, I2CADD
        mov #0x9240, w0
        mov w0, I2CCON
loop:   btss IFS0, #13
        bra loop
        bclr IFS0, #13
        btss I2CSTAT, #2
        bra wr
        mov I2CRCV, w1
        mov #0x5a, w0
        mov w0, I2CTRN
        bset I2CCON, #12
        bra loop
wr:     mov I2CRCV, w1
        bset I2CCON, #12
        bra loop
)";

// Two bytes to whoever reads, the second put into I2CTRN as soon as the first is out: a master that reads one
// refuses it, one that reads two need not wait. Published firmware for the robot is made so.
inline const std::string kEager = R"(
        .org 0x002E
        .pword served
        .org 0x200
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        mov #0x1f, w0
        mov w0, I2CADD
        mov #0x9300, w0
        mov w0, I2CCON
        bset IEC0, #13
rest:   bra rest
served: btsc I2CSTAT, #2
        bra send
        mov I2CRCV, w1
        bra over
send:   mov I2CRCV, w1
        mov #0x5a, w0
        mov w0, I2CTRN
        bset I2CCON, #12
first:  btsc I2CSTAT, #0
        bra first
        mov #0xa5, w0
        mov w0, I2CTRN
        bset I2CCON, #12
second: btsc I2CSTAT, #0
        bra second
over:   bclr I2CSTAT, #6
        bclr IFS0, #13
        retfie
)";

inline constexpr std::uint16_t kFile = 0x0A00, kGeneral = 0x0900, kLost = 0x0902, kSent = 0x0904;

/// A file of 256 registers at kFile behind a pointer, by interrupt; `main` is what it does beside. The word
/// at kGeneral counts bytes of general calls.
inline std::string register_file(int address, int control, const std::string& beside) {
    return fmt::format(R"(
        .org 0x002E
        .pword served
        .org 0x200
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        clr 0x0900
        clr 0x0902
        clr 0x0904
        mov #{}, w0
        mov w0, I2CADD
        mov #{}, w0
        mov w0, I2CCON
        mov #140, w0
        mov w0, I2CBRG
        bset IEC0, #13
{}
served: bclr IFS0, #13
        mov I2CSTAT, w0
        btst w0, #2
        bra nz, send
        mov I2CRCV, w1
        btst w0, #5
        bra nz, data
        setm w9
        bra free
data:   btst w0, #9
        bra z, mine
        inc 0x0900
mine:   cp0 w9
        bra z, store
        mov w1, w10
        clr w9
        bra free
store:  mov #0x0A00, w2
        add w2, w10, w2
        mov.b w1, [w2]
        inc w10, w10
free:   bset I2CCON, #12
        retfie
send:   mov I2CRCV, w1
        mov #0x0A00, w2
        add w2, w10, w2
        mov.b [w2], w1
        ze w1, w1
        mov w1, I2CTRN
        inc w10, w10
        bset I2CCON, #12
        retfie
)",
                       address, control, beside);
}

// A dsPIC33F at the ten-bit address 0x2A5: 256 registers behind a pointer, by interrupt.
inline const std::string kTenBitBoard = R"(
        .org 0x0034
        .pword served
        .org 0x200
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        mov #0x2A5, w0
        mov w0, I2C1ADD
        mov #0x9640, w0
        mov w0, I2C1CON
        bset IEC1, #0
rest:   bra rest
served: bclr IFS1, #0
        mov I2C1STAT, w0
        mov I2C1RCV, w1
        btst w0, #2
        bra nz, send
        btst w0, #5
        bra nz, data
        setm w9
        bra free
data:   cp0 w9
        bra z, store
        mov w1, w10
        clr w9
        bra free
store:  mov #0x0A00, w2
        add w2, w10, w2
        mov.b w1, [w2]
        inc w10, w10
        bra free
send:   mov #0x0A00, w2
        add w2, w10, w2
        mov.b [w2], w1
        ze w1, w1
        mov w1, I2C1TRN
        inc w10, w10
free:   bset I2C1CON, #12
        retfie
)";

// Writes a counter to register 7 of 0x20, again and again, however often it loses the bus.
inline const std::string kWritesToo = R"(
        clr w7
next:   inc w7, w7
        mov #4000, w3
pause:  dec w3, w3
        bra nz, pause
again:  bclr I2CSTAT, #10
        bset I2CCON, #0
start:  btsc I2CCON, #0
        bra start
        btsc I2CSTAT, #10
        bra lost
        mov #0x40, w4
        rcall put
        btsc I2CSTAT, #10
        bra lost
        mov #7, w4
        rcall put
        mov w7, w4
        rcall put
        bset I2CCON, #2
stop:   btsc I2CCON, #2
        bra stop
        inc 0x0904
        bra next
lost:   inc 0x0902
held:   btst I2CSTAT, #3
        bra nz, held
        bra again
put:    mov w4, I2CTRN
sends:  btsc I2CSTAT, #14
        bra sends
        return
)";

inline constexpr int kEnabled = 0x9240;  // I2CEN, SCLREL, DISSLW, STREN

}  // namespace puckloop::tests
