#pragma once
// Programs for the dsPIC30F6014A on the e-puck's board that play through DCI and codec at 7200 samples a
// second.

#include <string>

namespace puckloop::tests {

/// Sets the codec up as the e-puck's library does (PLL, speaker on, 0 dB), calls `before` once, then goes
/// round in `loop` (label sleep). The DCI's interrupt runs `sample` for each sample: it leaves the word in
/// w3, may use w2, w4 and keep what it likes in w5 to w9.
inline std::string sound_player(const std::string& sample, const std::string& before = {},
                                const std::string& loop = {}) {
    return R"(
        goto main
        .org 0x0066
        .pword isr
        .org 0x0100
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        bclr LATF, #0
        bclr TRISF, #0
        repeat #400
        nop
        bset LATF, #0
        mov #0x04EF, w0
        mov w0, DCICON2
        mov #3, w0
        mov w0, DCICON3
        mov #1, w0
        mov w0, TSCON
        mov w0, RSCON
        mov #0x0300, w1
        rcall prime
        bset DCICON1, #15
        mov #0x0413, w1
        rcall set
        mov #0x0118, w1
        rcall set
        mov #0x075F, w1
        rcall set
        mov #0, w1
        rcall set
last:   btss DCISTAT, #0
        bra last
        bclr DCICON1, #15
        mov #0x01EF, w0
        mov w0, DCICON2
        clr w5
)" + before +
           R"(
        bclr IFS2, #9
        bset IEC2, #9
        bset DCICON1, #15
sleep:  pwrsav #1
)" + loop + R"(
        bra sleep
set:    btss DCISTAT, #0
        bra set
prime:  mov #0x7FFF, w0
        cp0 w1
        bra nz, wanted
        clr w0
wanted: mov w0, TXBUF0
        mov w1, TXBUF1
        return
isr:    bclr IFS2, #9
)" + sample +
           R"(
        mov w3, TXBUF0
        mov RXBUF0, w2
        retfie
)";
}

}  // namespace puckloop::tests
