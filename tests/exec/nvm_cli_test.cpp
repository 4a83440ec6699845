// `exec --nvm`: what flash and EEPROM hold lasts from one run to the next. And the reset button.

#include "tests/exec/command.h"
#include "tests/exec/rig.h"
#include "tests/kit/dspic_pieces.h"

#include "emu/dspic/devices/device.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>

using namespace puckloop;
using Catch::Contains;
using exec::assembled;
using exec::one_line;
using exec::Outcome;
using exec::text_of;
using exec::Workbench;

namespace {

/// Counts its boots in EEPROM and writes itself a routine into flash the first time; sends on UART1 what the
/// routine returns ('?' while there is none, then 'U') and the count.
const std::string kBootCounter = tests::kMain + tests::kUart1 + tests::kCountBoots + R"(
        clr     w0
        mov     w0, TBLPAG
        mov     #0x2000, w1
        mov     #0x3f, w7
        tblrdl  [w1], w6
        inc     w6, w6
        bra     z, fresh
        call    0x2000
        mov     w0, w7
        bra     send
fresh:  tblwtl  w0, [w1]
        mov     #0x4041, w2             ; erase the flash row
        rcall   go
        mov     #0x0550, w3             ; mov #0x55, w0
        tblwtl  w3, [w1]
        mov     #0x0020, w3
        tblwth  w3, [w1]
        inc2    w1, w1
        clr     w3                      ; return
        tblwtl  w3, [w1]
        mov     #0x0006, w3
        tblwth  w3, [w1]
        mov     #0x4001, w2             ; write the row
        rcall   go
send:   mov     #0x30, w0
        add     w5, w0, w5
        mov     w7, U1TXREG
        mov     w5, U1TXREG
stop:   bra     stop
)" + tests::kWriteMemory;

std::string counter(const Workbench& bench, const std::string& name = "counter.hex",
                    const std::string& more = {}) {
    return bench.image(name, assembled(kBootCounter + more));
}

/// What it sends in one run with the arguments.
std::string sent(const Workbench& bench, const std::string& image, const std::string& arguments) {
    const Outcome run = bench.run("--board pic " + image + " --uart1 - --seconds 0.1 " + arguments);
    CHECK(run.status == 0);
    return run.out;
}

}  // namespace

TEST_CASE("a program that programs itself finds its flash and EEPROM in the next run") {
    const Workbench bench;
    const std::string image = counter(bench);
    const std::string nvm = " --nvm " + bench.folder + "/robot0.nvm";
    CHECK(sent(bench, image, "") == "?0");
    CHECK(sent(bench, image, "") == "?0");
    CHECK(sent(bench, image, nvm) == "?0");
    CHECK(sent(bench, image, nvm) == "U1");
    CHECK(sent(bench, image, nvm) == "U2");
    CHECK_FALSE(std::filesystem::exists(bench.folder + "/robot0.nvm.part"));

    // Its last part is an image.
    const std::string text = text_of(bench.folder + "/robot0.nvm");
    CHECK_THAT(text, Catch::StartsWith("puckloop non-volatile memory 1\nchip: dspic30f6014a\nimage: "));
    const std::string hex = bench.file("kept.hex", text.substr(text.find("\n:") + 1));
    CHECK(sent(bench, hex, "") == "U3");
}

TEST_CASE("a file that cannot be used is refused in one line, and stays as it is") {
    const Workbench bench;
    const std::string image = counter(bench);
    const std::string path = bench.folder + "/robot0.nvm";
    sent(bench, image, "--nvm " + path);
    const std::string good = text_of(path);
    const auto refused = [&](const std::string& target, const std::string& firmware,
                             const std::string& file) {
        const Outcome run = bench.run(target + " " + firmware + " --seconds 0.1 --nvm " + file);
        CHECK(run.status == 2);
        CHECK(one_line(run.err));
        return run.err;
    };
    const auto damaged = [&](std::string text) { return bench.file("damaged.nvm", text); };

    std::string flipped = good;
    flipped[good.size() / 2] = flipped[good.size() / 2] == '0' ? '1' : '0';
    CHECK_THAT(refused("--board pic", image, damaged(flipped)), Contains("do not match their checksum"));
    CHECK(text_of(bench.folder + "/damaged.nvm") == flipped);
    for (const std::size_t length : {0U, 10U, 40U, 150U, 200U})
        CHECK_THAT(refused("--board pic", image, damaged(good.substr(0, length))), Contains("damaged.nvm"));
    CHECK_THAT(refused("--board pic", image, damaged(std::string(300, 'x'))),
               Contains("line 1: is no file of non-volatile memory"));
    // The firmware itself is no such file, and must not be overwritten.
    CHECK_THAT(refused("--board pic", image, image), Contains("is no file of non-volatile memory"));

    const std::string other = counter(bench, "other.hex", "        nop\n");
    CHECK_THAT(refused("--board pic", other, path), Contains("line 3: began with another image than"));
    std::string foreign = good;
    foreign.replace(foreign.find("dspic30f6014a"), 13, "dspic33fj256gp710");
    CHECK_THAT(refused("--board pic", image, damaged(foreign)),
               Contains("line 2: is the memory of a dspic33fj256gp710"));
    CHECK_THAT(refused("--board pic", image, bench.folder + "/nowhere/x.nvm"), Contains("cannot be written"));
    CHECK_THAT(refused("--board pic", image, bench.folder), Contains("robot0.nvm") || Contains(bench.folder));
    CHECK(text_of(path) == good);
    CHECK(sent(bench, image, "--nvm " + path) == "U1");
}

TEST_CASE("the reset button: at a time, from the stimulus") {
    const Workbench bench;
    const std::string image = counter(bench);
    // Without supply lost the EEPROM counts on: three boots in one run.
    CHECK(sent(bench, image, "--reset-at 0.03 --reset-at 0.06") == "?0U1U2");
    const std::string presses = bench.file("presses.txt", "0.03 reset 1\n0.05 selector 3\n");
    CHECK(sent(bench, image, "--stimulus " + presses) == "?0U1");
    const Outcome bare = bench.run("--mcu dspic30f6014a " + image + " --seconds 0.1 --stimulus " +
                                   bench.file("bare.txt", "0.03 reset 1\n"));
    CHECK_THAT(bare.out, Contains("reset: EXTR at 0.030000 s"));
    const Outcome run = bench.run("--board pic " + image + " --seconds 0.1 --reset-at 0.03");
    CHECK_THAT(run.out, Contains("reset: EXTR at 0.030000 s"));
    const std::string held = bench.file("held.txt", "0.03 reset 0\n");
    const Outcome bad = bench.run("--mcu dspic30f6014a " + image + " --seconds 0.1 --stimulus " + held);
    CHECK(bad.status == 2);
    CHECK(one_line(bad.err));
    CHECK(bench.run("--board pic " + image + " --reset-at -1").status == 2);
}

namespace {

/// A record of the tinybld boot loader: the row's address, its 32 words, and what makes the sum 0.
std::string row_record(std::uint32_t row, const std::map<std::uint32_t, std::uint32_t>& words) {
    std::vector<unsigned> bytes{row & 0xFF, row >> 8 & 0xFF, row >> 16 & 0xFF, 0};
    for (std::uint32_t address = row; address < row + 64; address += 2) {
        const auto found = words.find(address);
        const std::uint32_t word = found == words.end() ? 0xFFFFFF : found->second;
        for (const int shift : {0, 8, 16})
            bytes.push_back(word >> shift & 0xFF);
    }
    unsigned sum = 0;
    for (const unsigned byte : bytes)
        sum += byte;
    bytes.push_back((0x100 - sum % 0x100) % 0x100);
    std::string text;
    for (const unsigned byte : bytes)
        text += fmt::format(" {:02x}", byte);
    return text;
}

}  // namespace

TEST_CASE("a boot loader session leaves its program, as on a robot") {
    const auto loader = exec::real_image("tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs.hex");
    if (!loader) return;
    const Workbench bench;
    // The program sends 'P' and lights LED 0; the loader's host puts a GOTO to it before the loader.
    const dspic::Program program = assembled(R"(
        .org    0x100
main:   mov     #7, w0
        mov     w0, U1BRG
        bset    U1MODE, #15
        bset    U1STA, #10
        bclr    TRISA, #6
        bset    LATA, #6
        mov     #0x50, w0
        mov     w0, U1TXREG
stop:   bra     stop
)");
    const std::map<std::uint32_t, std::uint32_t> jump{{0x17F38, 0x040100}, {0x17F3A, 0}};
    const std::string script = bench.file("upload.txt", "0.1 c1\n0.2" + row_record(0x100, program.words) +
                                                            "\n0.3" + row_record(0x17F00, jump) + "\n");
    const std::string common =
        "--board pic " + *loader + " --nvm " + bench.folder + "/robot0.nvm --log " + bench.folder + "/logs ";
    const Outcome upload = bench.run(common + "--seconds 0.5 --uart1 script:" + script);
    CHECK(upload.status == 0);
    const std::string answers = text_of(bench.folder + "/logs/uart1.csv");
    for (const char* answer : {"tx,71", "tx,4b"})  // 'q' and 'K'
        CHECK_THAT(answers, Contains(answer));
    CHECK_THAT(answers, !Contains("tx,4e"));  // 'N': a record came damaged

    // Next day: nobody speaks to the loader, its time is over after 1.09 s, and the program runs.
    const Outcome later = bench.run(common + "--seconds 3 --uart1 -");
    CHECK(later.out == "P");
    CHECK_THAT(text_of(bench.folder + "/logs/pins.csv"), Contains(",led0,1"));
    // Without the file the loader is alone.
    CHECK(bench.run("--board pic " + *loader + " --seconds 3 --uart1 -").out.empty());
}
