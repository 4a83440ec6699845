#include "tests/debug/drawn_reads.h"

#include "base/json.h"
#include "emu/avr/assembler/assembler.h"
#include "emu/avr/devices/device.h"
#include "tests/exec/command.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::tests {

namespace {

/// Few bytes, so that a program comes back to them; some have names.
constexpr std::uint32_t kFirst = 0x1800, kBytes = 64;
const VariablesByName kVariables{
    {"alpha", {kFirst, 7}}, {"beta", {kFirst + 7, 1}}, {"gamma", {kFirst + 16, 16}}};

std::string variable_at(std::uint32_t address) {
    for (const auto& [name, variable] : kVariables)
        if (address >= variable.address && address < variable.address + variable.bytes)
            return address == variable.address ? name
                                               : fmt::format("{}+{}", name, address - variable.address);
    return {};
}

/// The program's text, and what it does to RAM.
class Drawing {
  public:
    explicit Drawing(RandomStream& random) : random_(random) {}

    std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(random_.below(limit)); }
    std::uint32_t address(std::uint32_t room = 1) { return kFirst + below(kBytes - room); }
    void line(const std::string& text) { text_ += "        " + text + "\n"; }
    /// An instruction that accesses RAM.
    void access(const std::string& text) { text_ += fmt::format("at{}:\n        {}\n", accesses_++, text); }
    void label(const std::string& name) { text_ += name + ":\n"; }
    /// By the instruction of the last access().
    void write(std::uint32_t address, std::uint32_t bytes = 1) {
        for (std::uint32_t i = 0; i < bytes; ++i)
            written_.insert(address + i);
    }
    void read(std::uint32_t address, std::uint32_t bytes = 1, unsigned times = 1) {
        for (std::uint32_t i = 0; i < bytes; ++i)
            if (!written_.contains(address + i)) reads_.push_back({accesses_ - 1, address + i, times});
    }

    /// Label of the last access().
    std::string last() const { return fmt::format("at{}", accesses_ - 1); }
    const std::string& text() const { return text_; }
    DrawnReads result(const std::map<std::string, std::uint32_t>& symbols) const {
        DrawnReads drawn;
        drawn.main = symbols.at("main");
        for (const Found& found : reads_) {
            drawn.reads.push_back({symbols.at(fmt::format("at{}", found.access)), found.address,
                                   variable_at(found.address), found.times});
            drawn.in_all += found.times;
        }
        return drawn;
    }

  private:
    struct Found {
        unsigned access = 0;
        std::uint32_t address = 0;
        unsigned times = 0;
    };
    RandomStream& random_;
    std::string text_;
    std::set<std::uint32_t> written_;
    std::vector<Found> reads_;
    unsigned accesses_ = 0;
};

class AvrDrawing : public Drawing {
  public:
    using Drawing::Drawing;

    void draw() {
        line("jmp     main");
        line(".org    0x100");
        label("main");
        statement(7);
        for (std::uint32_t left = 15 + below(30); left > 0; --left)
            statement(below(11));
        label("stop");
        line("rjmp    stop");
        label("nothing");
        line("ret");
    }

  private:
    void point(const char* pair, std::uint32_t at) {
        const int low = pair[0] == 'X' ? 26 : pair[0] == 'Y' ? 28 : 30;
        line(fmt::format("ldi     r{}, {}", low, at & 0xFF));
        line(fmt::format("ldi     r{}, {}", low + 1, at >> 8));
    }
    void statement(std::uint32_t kind) {
        const std::uint32_t at = address(40), offset = below(40), times = 2 + below(4);
        switch (kind) {
        case 0:
            access(fmt::format("sts     {}, r16", at));
            return write(at);
        case 1:
            access(fmt::format("lds     r17, {}", at));
            return read(at);
        case 2:
            point("X", at);
            access("st      X+, r16");
            return write(at);
        case 3:
            point("X", at);
            access("ld      r17, -X");
            return read(at - 1);
        case 4:
            point("Y", at);
            access(fmt::format("ldd     r17, Y+{}", offset));
            return read(at + offset);
        case 5:
            point("Z", at);
            access(fmt::format("std     Z+{}, r16", offset));
            return write(at + offset);
        case 6:
            access("push    r16");
            write(sp_--);
            access("pop     r17");
            return read(++sp_);
        case 7:  // its return address is written, and read by RET
            access("call    nothing");
            write(sp_);
            return write(sp_ - 1);
        case 8:
            line(fmt::format("ldi     r20, {}", times));
            access(fmt::format("lds     r17, {}", at));
            line("dec     r20");
            line("brne    " + last());
            return read(at, 1, times);
        case 9:
            return elsewhere(at);
        default:
            return move_stack(1 + below(6));
        }
    }
    void elsewhere(std::uint32_t at) {
        point("Z", at & 0xFF);
        line("lpm     r17, Z+");
        line(fmt::format("ldi     r18, {}", at & 0xFF));
        line("out     EEARL, r18");
        line("sbi     EECR, 0");
        line("in      r17, EEDR");
    }
    void move_stack(std::uint32_t bytes) {
        sp_ -= bytes;
        line(fmt::format("ldi     r18, {}", sp_ & 0xFF));
        line("out     SPL, r18");
        line(fmt::format("ldi     r18, {}", sp_ >> 8));
        line("out     SPH, r18");
        access("pop     r17");
        read(++sp_);
    }

    std::uint32_t sp_ = 0x40FF;
};

class DspicDrawing : public Drawing {
  public:
    using Drawing::Drawing;

    void draw() {
        line("goto    main");
        line(".org    0x200");
        label("main");
        line("mov     #0x900, w15");
        line("mov     #0x1000, w0");
        line("mov     w0, SPLIM");
        line("clr     w5");
        for (std::uint32_t left = 15 + below(30); left > 0; --left)
            statement(below(9));
        label("stop");
        line("bra     stop");
        label("nothing");
        line("return");
    }

  private:
    void statement(std::uint32_t kind) {
        const std::uint32_t byte = address(20), word = byte & ~1u, times = 2 + below(4);
        switch (kind) {
        case 0:
            access(fmt::format("mov     w5, {:#x}", word));
            return write(word, 2);
        case 1:
            access(fmt::format("mov     {:#x}, w1", word));
            return read(word, 2);
        case 2:
            access(fmt::format("mov.b   WREG, {:#x}", byte));
            return write(byte);
        case 3:
            access(fmt::format("mov.b   {:#x}, WREG", byte));
            return read(byte);
        case 4:  // reads, then writes
            access(fmt::format("inc     {:#x}", word));
            read(word, 2);
            return write(word, 2);
        case 5:
            line(fmt::format("mov     #{:#x}, w2", word));
            line(fmt::format("repeat  #{}", times - 1));
            access("mov     [w2++], w3");
            return read(word, 2 * times);
        case 6:
            access("push    w5");
            write(kStack, 2);
            access("pop     w3");
            return read(kStack, 2);
        case 7:  // its return address is written, and read by RETURN
            access("rcall   nothing");
            return write(kStack, 4);
        default:
            line(fmt::format("mov     #{:#x}, w2", word));
            access("mov     w5, [w2]");
            return write(word, 2);
        }
    }

    static constexpr std::uint32_t kStack = 0x900;
};

}  // namespace

void DrawnReads::check(const nlohmann::json& stats) const {
    INFO(stats.dump());
    CHECK(stats.at("unwritten_reads") == in_all);
    std::vector<nlohmann::json> expected;
    for (const Read& read : reads)
        expected.push_back({{"address", read.address},
                            {"variable", read.variable},
                            {"pc", fmt::format("0x{:06x}", read.pc)},
                            {"place", read.pc == main ? "main" : fmt::format("main+{:#x}", read.pc - main)},
                            {"times", read.times}});
    std::vector<nlohmann::json> found = stats.at("unwritten");
    for (nlohmann::json& read : found) {
        read.erase("cycle");
        read.erase("line");
    }
    CHECK(found == expected);
}

DrawnReads draw_avr_reads(RandomStream& random, const VariablesByName& more) {
    AvrDrawing drawing(random);
    drawing.draw();
    INFO(drawing.text());
    const avr::Program program = avr::assemble(drawing.text(), {"source", &avr::atmega1284p()});
    DrawnReads drawn = drawing.result(program.symbols);
    VariablesByName variables = kVariables;
    variables.insert(more.begin(), more.end());
    drawn.elf = avr_elf(program.bytes, {{"main", drawn.main}}, variables);
    return drawn;
}

DrawnReads draw_dspic_reads(RandomStream& random, const dspic::DeviceInfo& device) {
    DspicDrawing drawing(random);
    drawing.draw();
    const dspic::Program program = exec::assembled(drawing.text(), device);
    DrawnReads drawn = drawing.result(program.symbols);
    drawn.elf = dspic_elf(program.words, {{"main", drawn.main}}, kVariables);
    return drawn;
}

}  // namespace puckloop::tests
