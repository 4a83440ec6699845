#pragma once
// The project's dsPIC assembler: two passes over one source text.
//
//   label: mov.w  #0x10, w0     ; comment    // comment
//          .equ   SIZE, 4*8     (or SIZE = 4*8)
//          .org   0x100         .text        .global _main
//          .pword 0x123456      .word 0x1234, label       .ascii "text"   .asciz "text"   (two characters a
//          word) .pfill 100, 0xffffff .include "other.s"        .end
//
// Syntax of instructions: the usual pic30 one (see disassembler.h). Expressions: see expression.h.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::dspic {

struct AssembledLine {
    std::uint32_t address = 0;
    int words = 0;
    int line = 0;
    std::string text;
};

struct Program {
    std::map<std::uint32_t, std::uint32_t> words;  ///< 24-bit words by even program address
    std::map<std::string, std::uint32_t> symbols;  ///< labels and .equ names
    std::vector<AssembledLine> lines;              ///< lines that yielded words, in source order

    std::uint32_t symbol(const std::string& name) const { return symbols.at(name); }
};

struct AssembleOptions {
    std::string file = "source";                      ///< name for messages, base of .include
    std::uint32_t origin = 0;                         ///< first address without .org
    std::map<std::string, std::uint32_t> predefined;  ///< names known beforehand (registers, say)
    bool keep_lines = false;                          ///< fill Program::lines
};

/// Throws InputError naming file and line, with a suggestion where one is near.
Program assemble(std::string_view source, const AssembleOptions& options = {});

/// The words of a few instructions in a row from address 0 on; for tests and tools.
std::vector<std::uint32_t> assemble_words(std::string_view source, std::uint32_t origin = 0);

}  // namespace puckloop::dspic
