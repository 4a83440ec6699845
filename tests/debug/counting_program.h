#pragma once
// A main board's program that counts, for tests of debuggers, and numbers drawn for it.

#include "tests/kit/dspic_pieces.h"

#include <random>
#include <string>

namespace puckloop::tests {

/// Uniform in [least, most].
inline unsigned draw(std::mt19937& random, unsigned least, unsigned most) {
    return least + static_cast<unsigned>(random() % (most - least + 1));
}

/// Counts in w2 and at 0x0A00 and switches an LED, from label loop on; `rest` takes its time and goes there
/// again.
inline std::string counting_program(const std::string& rest) {
    return kMain + R"(
        clr     TRISA
        clr     w2
loop:   inc     w2, w2
        mov     w2, 0x0A00
        btg     LATA, #7
)" + rest;
}

}  // namespace puckloop::tests
