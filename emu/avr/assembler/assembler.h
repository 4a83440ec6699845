#pragma once
// The project's AVR assembler: two passes over one source text, in the syntax of GNU as.
//
//   label: ldi   r24, lo8(label)       ; comment    // comment
//          .equ  SIZE, 4*8             (or SIZE = 4*8)
//          .org  0x100                 byte address, even
//          .word 0x1234, label         .byte 1, 2       .ascii "text"    .asciz "text"    .balign 2
//          .text .global main .include "other.s" .end
//
// Instructions: see disassembler.h. Program addresses count bytes. Names of registers of the chip are their
// I/O addresses below 0x40 and their data addresses above, so that `in r0, SREG` and `lds r0, UDR0` both
// work.

#include "emu/avr/devices/device.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::avr {

struct AssembledLine {
    std::uint32_t address = 0;
    int bytes = 0;
    int line = 0;
    std::string text;
};

struct Program {
    std::map<std::uint32_t, std::uint8_t> bytes;   ///< by byte address
    std::map<std::string, std::uint32_t> symbols;  ///< labels and .equ names
    std::vector<AssembledLine> lines;              ///< lines that yielded bytes, in source order

    std::uint32_t symbol(const std::string& name) const { return symbols.at(name); }
    std::uint16_t word(std::uint32_t address) const {
        return static_cast<std::uint16_t>(bytes.at(address) | bytes.at(address + 1) << 8);
    }
};

struct AssembleOptions {
    std::string file = "source";         ///< name for messages, base of .include
    const DeviceInfo* device = nullptr;  ///< whose register names are known
    bool keep_lines = false;             ///< fill Program::lines
};

/// Throws InputError naming file and line, with a suggestion where one is near.
Program assemble(std::string_view source, const AssembleOptions& options = {});

}  // namespace puckloop::avr
