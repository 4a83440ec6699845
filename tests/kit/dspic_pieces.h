#pragma once
// Pieces of test programs for the dsPIC30F6014A, to be put one after the other.

#include <string>

namespace puckloop::tests {

/// Reset vector, label main, stack.
inline const std::string kMain = R"(
        goto    main
        .org    0x100
main:   mov     #0x0900, w15
        mov     #0x27f0, w0
        mov     w0, SPLIM
)";

/// UART1 at 115 200 baud.
inline const std::string kUart1 = R"(
        mov     #7, w0
        mov     w0, U1BRG
        bset    U1MODE, #15
        bset    U1STA, #10
)";

/// One more in the first word of the EEPROM, which is left in w5: 0 at the first boot of a fresh chip. Needs
/// kWriteMemory.
inline const std::string kCountBoots = R"(
        mov     #0x7f, w0
        mov     w0, TBLPAG
        mov     #0xf000, w1
        tblrdl  [w1], w5
        inc     w5, w5
        mov     w1, NVMADR
        mov     w0, NVMADRU
        mov     #0x4044, w2             ; erase the EEPROM word
        rcall   go
        tblwtl  w5, [w1]
        mov     #0x4004, w2             ; write it
        rcall   go
)";

/// Subroutine go: the operation in w2 on flash or EEPROM, to its end.
inline const std::string kWriteMemory = R"(
go:     mov     w2, NVMCON
        mov     #0x55, w4
        mov     w4, NVMKEY
        mov     #0xaa, w4
        mov     w4, NVMKEY
        bset    NVMCON, #15
        nop
busy:   btsc    NVMCON, #15
        bra     busy
        return
)";

/// Waits for a character on UART2, for ever.
inline const std::string kWaitForCharacter = R"(
        mov     #0x8000, w0
        mov     w0, U2MODE
wait:   btss    U2STA, #0
        bra     wait
        bra     wait
)";

}  // namespace puckloop::tests
