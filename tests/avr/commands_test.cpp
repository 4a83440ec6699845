// asm, disasm, step and exec with --mcu atmega1284p, from the outside.

#include "tests/tools/shell.h"

#include <catch2/catch.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

using Catch::Contains;
using puckloop::tests::Ran;
using puckloop::tests::run_puckloop;

namespace {

namespace fs = std::filesystem;

class Folder {
  public:
    Folder() { fs::create_directories(path_); }
    ~Folder() { fs::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string file(const std::string& name, const std::string& content = "") const {
        if (!content.empty()) std::ofstream(path_ / name, std::ios::binary) << content;
        return (path_ / name).string();
    }

  private:
    fs::path path_ = fs::temp_directory_path() / ("puckloop_avr_commands." + std::to_string(::getpid()));
};

std::string content_of(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Echoes what arrives on USART0, plus one.
const std::string kEcho = R"(
        ldi  r16, 8         ; 115200 baud, nearly
        sts  UBRR0L, r16
        ldi  r16, 0x18
        sts  UCSR0B, r16
loop:   lds  r17, UCSR0A
        sbrs r17, 7
        rjmp loop
        lds  r18, UDR0
        inc  r18
        sts  UDR0, r18
        cpi  r18, 'Z'
        brne loop
end:    rjmp end
)";
const std::string kMcu = " --mcu atmega1284p ";

}  // namespace

TEST_CASE("AVR source, listing and image go in a circle") {
    const Folder folder;
    const std::string source = folder.file("a.s", kEcho), first = folder.file("first.hex");
    REQUIRE(run_puckloop("asm" + kMcu + source + " -o " + first).status == 0);
    const std::string text = folder.file("b.s"), second = folder.file("second.hex");
    REQUIRE(run_puckloop("disasm" + kMcu + first + " > " + text).status == 0);
    REQUIRE(run_puckloop("asm" + kMcu + text + " -o " + second).status == 0);
    CHECK(content_of(first) == content_of(second));
    CHECK_THAT(content_of(text), Contains("lds r17, 0x00c0"));
    const Ran list = run_puckloop("asm" + kMcu + source + " --format list");
    CHECK_THAT(list.output, Contains("00000: 08 e0"));
}

TEST_CASE("words, single steps and mistakes") {
    CHECK_THAT(run_puckloop("disasm" + kMcu + "--words 940e,0046,9519").output,
               Contains("call 0x8c") && Contains(".word 0x9519"));
    CHECK(run_puckloop("disasm" + kMcu + "--words 12345").status == 2);
    const Ran chip = run_puckloop("asm --mcu atmega328p /dev/null");
    CHECK(chip.status == 2);
    CHECK_THAT(chip.output, Contains("unknown chip \"atmega328p\"") && Contains("atmega1284p"));
    CHECK_THAT(run_puckloop("step --mcu atmega328p < /dev/null").output, Contains("atmega1284p"));
}

TEST_CASE("exec runs a program with its USART at a script's end, and stops where it is asked") {
    const Folder folder;
    const std::string hex = folder.file("echo.hex");
    REQUIRE(run_puckloop("asm" + kMcu + folder.file("echo.s", kEcho) + " -o " + hex).status == 0);
    const std::string script = folder.file("in.txt", "0.001 41 42 59\n");
    const std::string logs = folder.file("logs");
    const Ran run = run_puckloop("exec" + kMcu + hex + " --uart1 script:" + script +
                                 " --stop-at 0x22 --seconds 1 --json --log " + logs);
    CHECK(run.status == 0);
    CHECK_THAT(run.output, Contains("\"stopped\":\"0x22\"") && Contains("\"sent\":2") &&
                               Contains("\"received\":3") && Contains("\"cause\":\"power-on\"") &&
                               Contains("\"unmodelled\":[]"));
    const std::string log = content_of(logs + "/uart1.csv");
    CHECK_THAT(log, Contains(",rx,"));
    const Ran budget = run_puckloop("exec" + kMcu + hex + " --stop-at 0x22 --seconds 0.1");
    CHECK(budget.status == 1);
    CHECK_THAT(budget.output, Contains("work: 1600"));
    CHECK(
        run_puckloop("exec" + kMcu + hex + " --reset-at 0.05 --seconds 0.1 --json").output.find("external") !=
        std::string::npos);
}

TEST_CASE("exec: what an AVR's memories hold lasts from run to run") {
    const Folder folder;
    const std::string hex = folder.file("count.hex"), nvm = folder.file("count.nvm"),
                      logs = folder.file("logs");
    // Counts its starts in the EEPROM and sends the count.
    const std::string source = folder.file("count.s", R"(
        sbi  EECR, 0
        in   r16, EEDR
        inc  r16
        out  EEDR, r16
        sbi  EECR, 2
        sbi  EECR, 1
        ldi  r17, 8
        sts  UBRR0L, r17
        ldi  r17, 0x08
        sts  UCSR0B, r17
        sts  UDR0, r16
end:    rjmp end
)");
    REQUIRE(run_puckloop("asm" + kMcu + source + " -o " + hex).status == 0);
    const std::string command = "exec" + kMcu + hex + " --seconds 0.01 --log " + logs + " --nvm " + nvm;
    for (const char* count : {",tx,00,", ",tx,01,", ",tx,02,"}) {
        REQUIRE(run_puckloop(command + " --fuses 0xFF,0xD9,0xFD,0x3F").status == 0);
        CHECK_THAT(content_of(logs + "/uart1.csv"), Contains(count));
    }
    const std::string kept = content_of(nvm);
    CHECK_THAT(kept, Contains("chip: atmega1284p") && Contains(":03000000FFD9FD") && Contains(":010000003F"));
    // Without its four lines it is an image.
    const std::string image = folder.file("kept.hex", kept.substr(kept.find("\n:") + 1));
    REQUIRE(run_puckloop("exec" + kMcu + image + " --seconds 0.01 --log " + logs).status == 0);
    CHECK_THAT(content_of(logs + "/uart1.csv"), Contains(",tx,03,"));
    std::string damaged = kept;
    damaged[damaged.size() - 20] ^= 1;
    folder.file("count.nvm", damaged);
    const Ran refused = run_puckloop(command);
    CHECK(refused.status == 2);
    CHECK_THAT(refused.output, Contains("is damaged"));
}

TEST_CASE("exec: fuses, supply and what no model is behind, of an AVR") {
    const Folder folder;
    const std::string hex = folder.file("a.hex");
    const std::string source = folder.file("a.s", "ldi r16, 1\n sts OSCCAL, r16\nend: rjmp end\n");
    REQUIRE(run_puckloop("asm" + kMcu + source + " -o " + hex).status == 0);
    const auto run = [&](const std::string& options) {
        return run_puckloop("exec" + kMcu + hex + " --seconds 0.01 " + options);
    };
    CHECK_THAT(run("--fuses 0x62,0xD9,0xFF").output, Contains("work: 1000"));
    for (const char* wrong : {"--fuses 0x62", "--fuses 0x62,0xD9,0x1FF", "--fuses 62,D9,FF", "--fosc 0xFF"}) {
        const Ran result = run(wrong);
        CHECK(result.status == 2);
        CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
    }
    CHECK(run_puckloop("exec --mcu dspic30f6014a " + hex + " --fuses 0xFF,0xD9,0xFD").status == 2);
    const Ran strict = run("--strict");
    CHECK(strict.status == 1);
    CHECK_THAT(strict.output, Contains("writes OSCCAL, which no model is behind"));
    const std::string stimulus =
        folder.file("supply.txt", "0.002 vcc 2\n0.003 vcc 5\n0.005 vcc 0\n0.006 vcc 3.3\n");
    const Ran supply = run("--json --stimulus " + stimulus);
    CHECK_THAT(supply.output, Contains("\"time_s\":0.0020020625,\"cause\":\"brown-out\"") &&
                                  Contains("\"time_s\":0.005,\"cause\":\"power-on\""));
}

TEST_CASE("exec: an AVR as master of devices, and as slave of a script") {
    const Folder folder;
    const std::string hex = folder.file("master.hex"), logs = folder.file("logs");
    // Addresses 0x62 and 0x60, then reads two bytes of 0x60; what TWSR said goes out by USART0.
    const std::string source = folder.file("master.s", R"(
        ldi  r17, 8
        sts  UBRR0L, r17
        ldi  r17, 0x08
        sts  UCSR0B, r17
        ldi  r17, 72
        sts  TWBR, r17
        ldi  r18, 0xC4
        rcall address
        rcall stop
        ldi  r18, 0xC0
        rcall address
        rcall stop
        ldi  r18, 0xC1
        rcall address
        ldi  r16, 0xC4
        rcall go
        ldi  r16, 0x84
        rcall go
        rcall stop
end:    rjmp end
address: ldi r16, 0xA4
        rcall go
        sts  TWDR, r18
        ldi  r16, 0x84
go:     sts  TWCR, r16
wait:   lds  r17, TWCR
        sbrs r17, 7
        rjmp wait
        lds  r17, TWSR
send:   lds  r19, UCSR0A
        sbrs r19, 5
        rjmp send
        sts  UDR0, r17
        ret
stop:   ldi  r16, 0x94
        sts  TWCR, r16
over:   lds  r17, TWCR
        sbrc r17, 4
        rjmp over
        ret
)");
    REQUIRE(run_puckloop("asm" + kMcu + source + " -o " + hex).status == 0);
    const Ran run =
        run_puckloop("exec" + kMcu + hex + " --seconds 0.02 --i2c-device ground --json --log " + logs);
    INFO(run.output);
    CHECK(run.status == 0);
    CHECK_THAT(run.output,
               Contains("\"i2c_bus\"") && Contains("\"bytes_read\":2") && Contains("\"not_acknowledged\":1"));
    CHECK(run_puckloop("exec" + kMcu + hex +
                       " --seconds 0.02 --i2c-device turret@0x60 --i2c-device ground@0x62 --strict")
              .status == 0);
    const Ran strict = run_puckloop("exec" + kMcu + hex + " --seconds 0.02 --i2c-device ground --strict");
    CHECK(strict.status == 1);
    CHECK_THAT(strict.output, Contains("addressed 0x62 on the two-wire bus, and nobody acknowledged"));
    std::string said;
    const std::string log = content_of(logs + "/uart1.csv");
    for (std::size_t at = log.find(",tx,"); at != std::string::npos; at = log.find(",tx,", at + 1))
        said += log.substr(at + 4, 2) + " ";
    CHECK(said == "08 20 08 18 08 40 50 58 ");
    CHECK_THAT(run_puckloop("exec --board tam " + hex + " --i2c-device ground").output,
               Contains("LED driver"));
#ifdef AVR_PROGRAMS
    const std::string script =
        folder.file("script.txt", "0.001 w 0x00 03 a1 b2 c3\n0.005 r 0x00 3 3\n0.01 w 0x11 01\n");
    const Ran slave = run_puckloop("exec" + kMcu + AVR_PROGRAMS +
                                   "/twi_slave.elf --seconds 0.02 --json --i2c script:" + script);
    INFO(slave.output);
    CHECK(slave.status == 0);
    CHECK_THAT(slave.output, Contains("\"bytes\":\"a1 b2 c3\"") && Contains("\"addresses_refused\":1") &&
                                 Contains("\"played\":3"));
#endif
}

TEST_CASE("an image for another chip, cut short or past the flash is refused in one line") {
    const Folder folder;
    const auto refused = [&](const std::string& file, const std::string& why) {
        const Ran result = run_puckloop("exec" + kMcu + file + " --seconds 0.01");
        INFO(result.output);
        CHECK(result.status == 2);
        CHECK_THAT(result.output, Contains(why));
        CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
    };
    refused(folder.file("none.hex"), "no such file");
    refused(folder.file("far.hex", ":020000040002F8\n:0100000000FF\n:00000001FF\n"), "lies past the flash");
    refused(folder.file("text.txt", "hello"), "in no known image format");
#ifdef AVR_PROGRAMS
    const std::string elf = content_of(AVR_PROGRAMS "/compute-Os.elf");
    REQUIRE(elf.size() > 1000);
    std::string other = elf;
    other[0x24] = 5;  // e_flags: avr5
    refused(folder.file("avr5.elf", other), "is for another AVR, architecture avr5 (expected avr51");
    std::string named = elf;
    const auto name = named.find(std::string("\0atmega1284p", 12));
    if (name != std::string::npos) {
        named.replace(name + 1, 11, "atmega1281x");
        refused(folder.file("1281.elf", named), "is for the atmega1281x (expected atmega1284p)");
    }
    refused(folder.file("cut.elf", elf.substr(0, 700)), "puckloop:");
    const Ran main = run_puckloop("exec" + kMcu + AVR_PROGRAMS "/compute-Os.elf --stop-at main --json");
    CHECK(main.status == 0);
    CHECK_THAT(main.output, Contains("\"symbol\":\"main\""));
    CHECK_THAT(run_puckloop("disasm" + kMcu + AVR_PROGRAMS "/compute-Os.elf --start main").output,
               Contains("main:\n"));
#endif
}
