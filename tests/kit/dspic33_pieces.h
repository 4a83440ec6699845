#pragma once
// Pieces of test programs for the dsPIC33FJ256GP710.

#include <string>

namespace puckloop::tests {

/// Asks for the clock source with this number (NOSC), by the keys of both bytes of OSCCON.
inline std::string clock_switch(int source) {
    return R"(
        mov     #0x743, w1
        mov     #0x78, w2
        mov     #0x9A, w3
        mov     #)" +
           std::to_string(source) + R"(, w4
        mov.b   w2, [w1]
        mov.b   w3, [w1]
        mov.b   w4, [w1]
        mov     #0x742, w1
        mov     #0x46, w2
        mov     #0x57, w3
        mov     #1, w4
        mov.b   w2, [w1]
        mov.b   w3, [w1]
        mov.b   w4, [w1]
)";
}

}  // namespace puckloop::tests
