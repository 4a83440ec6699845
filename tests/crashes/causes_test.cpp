// Why the chip was reset or trapped, as the firmware itself reads it back: RCON or MCUSR before anything else
// runs, INTCON1 and the stacked program counter in a trap's handler. It reports by its UART, and the run's
// report has to say the same. Sources: dsPIC30F Family Reference Manual, sections 6 and 8; DS70286, section
// 6; ATmega1284P data sheet, "System Control and Reset".

#include "base/json.h"
#include "base/random.h"
#include "emu/avr/assembler/assembler.h"
#include "emu/avr/devices/device.h"
#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/devices/device.h"
#include "tests/crashes/crash_image.h"
#include "tests/kit/scratch.h"
#include "tests/tools/shell.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

using namespace puckloop;

namespace {

/// What the firmware sent, and the run's report.
struct Told {
    std::string bytes;
    nlohmann::json report;

    std::uint8_t byte(std::size_t i) const {
        REQUIRE(i < bytes.size());
        return static_cast<std::uint8_t>(bytes[i]);
    }
    std::uint16_t word(std::size_t i) const { return static_cast<std::uint16_t>(byte(i) | byte(i + 1) << 8); }
};

Told told_by(const std::string& chip, const std::string& content, const std::string& options) {
    const tests::ImageFile image("cause", content);
    const std::filesystem::path folder = tests::scratch_path("cause_logs");
    const auto result = tests::run_puckloop(
        fmt::format("exec --mcu {} {} --json --log {} {}", chip, image.path, folder.string(), options));
    INFO(result.output);
    REQUIRE(result.status == 0);
    Told told;
    told.report = nlohmann::json::parse(result.output.substr(result.output.find('{')));
    std::ifstream log(folder / "uart1.csv");
    for (std::string line; std::getline(log, line);) {
        std::istringstream columns(line);
        std::string time, direction, byte;
        std::getline(columns, time, ',');
        std::getline(columns, direction, ',');
        std::getline(columns, byte, ',');
        if (direction == "tx") told.bytes += static_cast<char>(std::stoul(byte, nullptr, 16));
    }
    std::filesystem::remove_all(folder);
    return told;
}

/// What `entry` of the report's list states is at a place in the function guilty.
std::uint32_t guilty_pc(const nlohmann::json& entry) {
    INFO(entry.dump());
    CHECK(entry.at("symbol").get<std::string>().starts_with("guilty"));
    return static_cast<std::uint32_t>(std::stoul(entry.at("pc").get<std::string>(), nullptr, 16));
}

// RCON and INTCON1, by the manual.
constexpr unsigned kPor = 1u << 0, kBor = 1u << 1, kWdto = 1u << 4, kSwr = 1u << 6, kExtr = 1u << 7,
                   kIopuwr = 1u << 14, kTrapr = 1u << 15;
constexpr unsigned kOscfail = 1u << 1, kStkerr = 1u << 2, kAddrerr = 1u << 3, kMatherr = 1u << 4,
                   kDiv0err = 1u << 6;

struct DspicPart {
    const char* mcu;
    const dspic::DeviceInfo& device;
    unsigned brg;            ///< of U1BRG, for 115 200 baud at the clock of its reset
    std::uint32_t watchdog;  ///< address of FWDT
};
const DspicPart kDspicParts[] = {{"dspic30f6014a", dspic::dspic30f6014a(), 7, 0xF80002},
                                 {"dspic33fj256gp710", dspic::dspic33fj256gp710(), 1, 0xF8000A}};

/// After a reset it sends R and RCON. After the first one it writes `left` to RCON and calls guilty. A trap's
/// handler sends T, a letter, INTCON1, RCON and the two stacked words, clears INTCON1 and sends it again.
std::string dspic_image(const DspicPart& part, unsigned left, std::uint32_t place, const std::string& body) {
    dspic::AssembleOptions options;
    for (const dspic::RegisterInfo& info : part.device.registers)
        options.predefined[std::string(info.name)] = info.address;
    const unsigned stack = part.device.ram_start + 0x100u;
    const dspic::Program program =
        dspic::assemble(fmt::format(R"(
        goto    start
        .org    0x06
        .pword  oscillator, address, stack, math
        .org    0x200
start:  mov     RCON, w8
        mov     #{0:#x}, w15
        mov     #{1:#x}, w0
        mov     w0, SPLIM
        nop
        mov     #{2}, w0
        mov     w0, U1BRG
        mov     #0x8000, w0
        mov     w0, U1MODE
        mov     #0x0400, w0
        mov     w0, U1STA
        mov     #0x52, w0
        call    send
        mov     w8, w9
        call    send_word
        btss    w8, #0
        bra     calm
        mov     #{3:#x}, w0
        mov     w0, RCON
        call    guilty
        mov     #0x43, w0
        call    send
calm:   bclr    RCON, #5
last:   bra     last
oscillator: btsc w1, #0
        mov     [w1], w2
        mov     #0x4F, w7
        bra     trap
address: mov    #0x41, w7
        bra     trap
stack:  mov     #0x53, w7
        bra     trap
math:   mov     #0x4D, w7
trap:   mov     w15, w12
        mov     [--w12], w11
        mov     [--w12], w10
        mov     #{0:#x}, w15
        mov     #0x54, w0
        call    send
        mov     w7, w0
        call    send
        mov     INTCON1, w9
        call    send_word
        mov     RCON, w9
        call    send_word
        mov     w10, w9
        call    send_word
        mov     w11, w9
        call    send_word
        clr     INTCON1
        mov     INTCON1, w9
        call    send_word
        bra     last
send_word: mov  w9, w0
        call    send
        lsr     w9, #8, w0
send:   mov     #0xFF, w6
        and     w0, w6, w0
        mov     w0, U1TXREG
        nop
        nop
wait:   btss    U1STA, #8
        bra     wait
        return
        .org    {4:#x}
guilty: nop
{5}
        .org    {6:#x}
        .pword  0x000000
)",
                                    stack, stack + 0x400, part.brg, left, place, body, part.watchdog),
                        options);
    tests::Labels labels;
    for (const char* name : {"start", "oscillator", "send", "guilty"})
        labels[name] = program.symbol(name);
    return tests::dspic_elf(program.words, labels);
}

struct TrapKind {
    char letter;
    const char* name;
    unsigned flags30, flags33;
    const char* body;
};
constexpr TrapKind kTraps[] = {
    {'S', "StackError", kStkerr, kStkerr, "again:  rcall again\n"},
    {'M', "MathError", kMatherr, kMatherr | kDiv0err,
     "        clr w3\n        mov #7, w2\n        repeat #17\n        div.u w2, w3\n        nop\n        "
     "return\n"},
    {'A', "AddressError", kAddrerr, kAddrerr,
     "        mov #0x0901, w1\n        mov [w1], w2\n        nop\n        return\n"},
};

struct ResetKind {
    const char* cause;
    unsigned flag;
    const char* body;
    const char* options = "";
};
constexpr ResetKind kResets[] = {
    {"IOPUWR", kIopuwr, "        .pword 0x3fffff\n"},
    {"IOPUWR", kIopuwr, "        mov [w13], w2\n"},  // a pointer that nobody wrote
    {"SWR", kSwr, "        reset\n"},
    {"WDTO", kWdto, "        bset RCON, #5\nhere:   bra here\n"},
    {"EXTR", kExtr, "here:   bra here\n", "--reset-at 0.008"},
    {"BOR", kBor, "here:   bra here\n", "--stimulus {}"},
};

/// Flags of RCON that a program may leave set, drawn: a reset adds its own and takes none away.
unsigned drawn_flags(RandomStream& random) {
    return static_cast<unsigned>(random.next()) &
           (kBor | kWdto | kSwr | kExtr | kIopuwr | kTrapr | 1u << 3 | 1u << 2);
}

}  // namespace

TEST_CASE("a dsPIC's firmware finds the cause of its reset in RCON, and the report agrees") {
    RandomStream random(Catch::rngSeed(), "reset causes");
    const tests::ImageFile dip("dip", "0.008 vdd 1.9\n0.009 vdd 3.3\n");
    for (const DspicPart& part : kDspicParts)
        for (const ResetKind& kind : kResets) {
            const std::uint32_t place = 0x1000 + 2 * static_cast<std::uint32_t>(random.next() % 0x6000);
            const unsigned left = drawn_flags(random);
            const Told told = told_by(part.mcu, dspic_image(part, left, place, kind.body),
                                      "--seconds 0.3 " + fmt::format(fmt::runtime(kind.options), dip.path));
            // A 33FJ's brown-out clears what the others leave, but for EXTR.
            const unsigned kept = kind.flag == kBor && part.device.family_33f ? left & kExtr : left;
            INFO(part.mcu << " " << kind.cause << " left " << fmt::format("{:#06x}", left) << "\n"
                          << told.report.dump());
            REQUIRE(told.bytes.size() == 6);
            CHECK(told.bytes[0] == 'R');
            CHECK((told.word(1) & 0xC0DF) == (kPor | kBor));  // power-up, all others 0
            CHECK(told.bytes[3] == 'R');
            CHECK((told.word(4) & 0xC0DF) == (kept | kind.flag));
            const auto& resets = told.report.at("resets");
            REQUIRE(resets.size() == 2);
            CHECK(resets[0].at("cause") == "POR");
            CHECK(resets[1].at("cause") == kind.cause);
            const std::uint32_t pc = guilty_pc(resets[1]);
            CHECK(pc >= place);
            CHECK(pc <= place + 0x10);
        }
}

TEST_CASE("an address error in the handler of a higher trap resets a dsPIC with RCON<TRAPR>") {
    RandomStream random(Catch::rngSeed(), "trap conflict");
    for (const DspicPart& part : kDspicParts) {
        const unsigned left = drawn_flags(random);
        const Told told = told_by(part.mcu,
                                  dspic_image(part, left, 0x1000,
                                              "        mov #0x0901, w1\n        bset INTCON1, #1\n        "
                                              "nop\n        nop\n        return\n"),
                                  "--seconds 0.02");
        INFO(part.mcu << "\n" << told.report.dump());
        REQUIRE(told.bytes.size() == 6);
        CHECK(told.bytes[3] == 'R');
        CHECK((told.word(4) & 0xC0DF) == (left | kTrapr));
        const auto& resets = told.report.at("resets");
        REQUIRE(resets.size() == 2);
        CHECK(resets[1].at("cause") == "TRAPR");
        CHECK(resets[1].at("symbol").get<std::string>().starts_with("oscillator"));
        REQUIRE(told.report.at("traps").size() == 1);
        CHECK(told.report.at("traps")[0].at("name") == "OscillatorFail");
    }
}

TEST_CASE("a dsPIC's trap handler finds its flag in INTCON1 and the place on its stack") {
    RandomStream random(Catch::rngSeed(), "trap causes");
    for (const DspicPart& part : kDspicParts)
        for (const TrapKind& kind : kTraps) {
            const std::uint32_t place = 0x1000 + 2 * static_cast<std::uint32_t>(random.next() % 0x6000);
            const unsigned left = drawn_flags(random);
            const Told told = told_by(part.mcu, dspic_image(part, left, place, kind.body), "--seconds 0.02");
            INFO(part.mcu << " " << kind.name << "\n" << told.report.dump());
            REQUIRE(told.bytes.size() == 15);
            CHECK(told.bytes[3] == 'T');
            CHECK(told.bytes[4] == kind.letter);
            CHECK(told.word(5) == (part.device.family_33f ? kind.flags33 : kind.flags30));
            CHECK((told.word(7) & 0xC0DF) == left);  // a trap is no reset
            CHECK(told.word(13) == 0);
            const auto& traps = told.report.at("traps");
            REQUIRE(traps.size() == 1);
            CHECK(traps[0].at("name") == kind.name);
            const std::uint32_t stacked = (told.word(11) & 0x7Fu) << 16 | told.word(9);
            CHECK(stacked == guilty_pc(traps[0]));
            CHECK(told.report.at("resets").size() == 1);
        }
}

TEST_CASE("a dsPIC that ran into erased flash comes into its address error handler") {
    RandomStream random(Catch::rngSeed(), "erased causes");
    for (const DspicPart& part : kDspicParts) {
        const std::uint32_t target = 0x8000 + 2 * static_cast<std::uint32_t>(random.next() % 0x2000);
        const Told told = told_by(
            part.mcu,
            dspic_image(part, 0, 0x1000, fmt::format("        mov #{:#x}, w1\n        goto w1\n", target)),
            "--seconds 0.1");
        INFO(part.mcu << "\n" << told.report.dump());
        REQUIRE(told.bytes.size() == 15);
        CHECK(told.bytes.substr(3, 2) == "TA");
        CHECK(told.word(5) == kAddrerr);
        const std::uint32_t stacked = (told.word(11) & 0x7Fu) << 16 | told.word(9);
        CHECK(stacked >= part.device.flash_end);
        CHECK(told.report.at("traps").at(0).at("pc") == fmt::format("0x{:04x}", stacked));
        CHECK(told.report.at("warnings")
                  .dump()
                  .find(fmt::format("runs into erased flash (pc 0x{:04x}", target)) != std::string::npos);
    }
}

TEST_CASE("a dsPIC's flash holds what was written with the unlock sequence, and nothing without") {
    RandomStream random(Catch::rngSeed(), "unlock");
    for (const DspicPart& part : kDspicParts)
        for (const bool unlocked : {false, true}) {
            const unsigned value = static_cast<unsigned>(random.next() % 0xFFFF);
            // N, NVMCON, and the word that was to be written.
            const std::string body = fmt::format(R"(
        clr     TBLPAG
        mov     #0x7000, w1
        mov     #{:#x}, w5
        tblwtl  w5, [w1]
        mov     #0x4001, w2
        mov     w2, NVMCON
        mov     #0x55, w2
        mov     w2, NVMKEY
        mov     #{:#x}, w2
        mov     w2, NVMKEY
        bset    NVMCON, #15
        nop
        nop
busy:   btsc    NVMCON, #15
        bra     busy
        mov     #0x4E, w0
        call    send
        mov     NVMCON, w9
        call    send_word
        tblrdl  [w1], w9
        call    send_word
        return
)",
                                                 value, unlocked ? 0xAA : 0xAB);
            const Told told = told_by(part.mcu, dspic_image(part, 0, 0x1000, body), "--seconds 0.02");
            INFO(part.mcu << " " << unlocked << "\n" << told.report.dump());
            REQUIRE(told.bytes.size() == 9);
            CHECK(told.bytes[3] == 'N');
            CHECK(told.word(4) == 0x4001);
            CHECK(told.word(6) == (unlocked ? value : 0xFFFF));
            CHECK(told.bytes[8] == 'C');
            const std::string warnings = told.report.at("warnings").dump();
            INFO(warnings);
            CHECK((warnings.find("set NVMCON<WR> without the unlock sequence") != std::string::npos) !=
                  unlocked);
            CHECK((warnings.find("in guilty") != std::string::npos) != unlocked);
        }
}

namespace {

// MCUSR, by the data sheet.
constexpr unsigned kPorf = 1, kExtrf = 2, kBorf = 4, kWdrf = 8;

/// After power-up, of which RAM knows, it sends R and MCUSR, writes `left` to that and calls guilty; after
/// any other start it sends the two, clears MCUSR, and switches the watchdog off if `calm`.
std::string avr_image(unsigned left, bool calm, std::uint32_t place, const std::string& body) {
    const avr::Program program = avr::assemble(fmt::format(R"(
        jmp     start
        .org    0x100
start:  in      r20, MCUSR
        ldi     r16, 0xFF
        out     SPL, r16
        ldi     r16, 0x40
        out     SPH, r16
        ldi     r16, 8
        sts     UBRR0L, r16
        ldi     r16, 8
        sts     UCSR0B, r16
        ldi     r16, 0x52
        call    send
        mov     r16, r20
        call    send
        lds     r17, 0x200
        cpi     r17, 0xA5
        breq    again
        ldi     r17, 0xA5
        sts     0x200, r17
        ldi     r16, {0}
        out     MCUSR, r16
        call    guilty
        ldi     r16, 0x43
        call    send
last:   rjmp    last
again:  clr     r16
        out     MCUSR, r16
        ldi     r16, {1}
        sts     WDTCSR, r16
        clr     r16
        sts     WDTCSR, r16
        rjmp    last
send:   sts     UDR0, r16
wait:   lds     r17, UCSR0A
        sbrs    r17, 6
        rjmp    wait
        ldi     r17, 0x40
        sts     UCSR0A, r17
        ret
        .org    {2:#x}
guilty: nop
{3}
)",
                                                           left, calm ? 0x18 : 0, place, body),
                                               {"source", &avr::atmega1284p()});
    tests::Labels labels;
    for (const char* name : {"start", "send", "last", "guilty"})
        labels[name] = program.symbol(name);
    return tests::avr_elf(program.bytes, labels);
}

struct AvrKind {
    const char* cause;
    unsigned flag;
    const char* body;
    const char* options = "";
};
constexpr AvrKind kAvrResets[] = {
    {"watchdog", kWdrf,
     "        ldi r16, 0x18\n        sts WDTCSR, r16\n        ldi r16, 0x08\n        sts WDTCSR, r16\nhere:  "
     " "
     "rjmp here\n"},
    {"external", kExtrf, "here:   rjmp here\n", "--reset-at 0.03"},
    {"brown-out", kBorf, "here:   rjmp here\n", "--stimulus {}"},
};

}  // namespace

TEST_CASE("an AVR's firmware finds the cause of its reset in MCUSR, and the report agrees") {
    RandomStream random(Catch::rngSeed(), "AVR causes");
    const tests::ImageFile dip("dip", "0.03 vcc 2.4\n0.04 vcc 5\n");
    for (const AvrKind& kind : kAvrResets) {
        const std::uint32_t place = 0x1000 + 2 * static_cast<std::uint32_t>(random.next() % 0x4000);
        const unsigned left = random.next() % 2 ? kPorf : 0;
        const Told told = told_by("atmega1284p", avr_image(left, true, place, kind.body),
                                  "--seconds 0.3 " + fmt::format(fmt::runtime(kind.options), dip.path));
        INFO(kind.cause << "\n" << told.report.dump());
        REQUIRE(told.bytes.size() == 4);
        CHECK(told.bytes[0] == 'R');
        CHECK(told.byte(1) == kPorf);
        CHECK(told.bytes[2] == 'R');
        CHECK(told.byte(3) == (left | kind.flag));
        const auto& resets = told.report.at("resets");
        REQUIRE(resets.size() == 2);
        CHECK(resets[1].at("cause") == kind.cause);
        const std::uint32_t pc = guilty_pc(resets[1]);
        CHECK(pc >= place);
        CHECK(pc <= place + 0x14);
    }
}

TEST_CASE("an AVR whose watchdog has reset it is reset again until its firmware switches it off") {
    const Told told =
        told_by("atmega1284p", avr_image(0, false, 0x1000, kAvrResets[0].body), "--seconds 0.1");
    INFO(told.report.dump());
    REQUIRE(told.bytes.size() >= 10);
    for (std::size_t i = 2; i < told.bytes.size(); i += 2) {
        CHECK(told.bytes[i] == 'R');
        CHECK(told.byte(i + 1) == kWdrf);
    }
    CHECK(told.report.at("resets").size() == told.bytes.size() / 2);
}

TEST_CASE("what is no reset on an AVR leaves MCUSR alone") {
    RandomStream random(Catch::rngSeed(), "AVR, no reset");
    const std::uint32_t place = 0x1000 + 2 * static_cast<std::uint32_t>(random.next() % 0x4000);
    const unsigned left = random.next() % 2 ? kPorf : 0;
    const auto run = [&](const std::string& body) {
        return told_by("atmega1284p", avr_image(left, true, place, body), "--seconds 0.1");
    };
    const std::uint32_t target = 0x9000 + 2 * static_cast<std::uint32_t>(random.next() % 0x2000);
    const Told erased = run(fmt::format("        jmp {:#x}\n", target));
    INFO(erased.report.dump());
    REQUIRE(erased.bytes.size() == 4);  // starts over, and it was no reset
    CHECK(erased.bytes[2] == 'R');
    CHECK(erased.byte(3) == left);
    CHECK(erased.report.at("resets").size() == 1);

    const Told undefined = run("        .word 0x0001\n        ret\n");
    CHECK(undefined.bytes.substr(2) == "C");
    CHECK(undefined.report.at("resets").size() == 1);

    // A page write from outside the boot section: the word is still erased.
    const Told unwritten = run(R"(
        ldi     r30, 0x00
        ldi     r31, 0xC0
        ldi     r16, 0x12
        mov     r0, r16
        mov     r1, r16
        ldi     r16, 1
        out     0x37, r16
        spm
        ldi     r16, 5
        out     0x37, r16
        spm
        lpm     r16, Z
        call    send
        ret
)");
    INFO(unwritten.report.dump());
    REQUIRE(unwritten.bytes.size() == 4);
    CHECK(unwritten.byte(2) == 0xFF);
    CHECK(unwritten.bytes[3] == 'C');
    const std::string warnings = unwritten.report.at("warnings").dump();
    CHECK(warnings.find("SPM writes nothing: it is outside the boot section") != std::string::npos);
    CHECK(warnings.find("in guilty") != std::string::npos);
}
