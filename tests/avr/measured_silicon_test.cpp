// What was measured on parts, and published: absolute values, each by a small program of ours. The data, with
// sources, are in measured_silicon.csv; docs/measured_silicon.md has the table.

#include "base/text/csv.h"
#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <string>

using namespace puckloop;
using namespace puckloop::avr;
using test::Rig;

namespace {

constexpr Cycle kLong = 20'000;

/// What the program leaves at 0x100.
int left(const std::string& source) {
    Rig rig(source + "        sts 0x100, r17\nend:    rjmp end\n");
    rig.run(kLong);
    return rig.ram(0x100);
}

std::string times(int count, const std::string& line) {
    std::string text;
    for (int i = 0; i < count; ++i)
        text += line;
    return text;
}

int count_after_out(const std::string& value, const std::string& between) {
    return left("ldi r16, 1\nout TCCR0B, r16\nldi r16, " + value + "\nout TCNT0, r16\n" + between +
                "in r17, TCNT0\n");
}

int count_after_start(const std::string& between) {
    return left("nop\nnop\nnop\neor r1, r1\nldi r16, 1\nsts TCCR2B, r16\n" + between + "lds r17, TCNT2\n");
}

/// Fast PWM with TOP = 0: the counter rests at 0, and a value written above TOP runs to MAX once.
int one_shot(int clocks) {
    Rig rig("sbi DDRD, 6\neor r1, r1\nsts TCNT2, r1\nsts OCR2A, r1\nldi r16, " +
            std::to_string(255 - (clocks - 1)) +
            "\nsts OCR2B, r16\nldi r17, 0x33\nsts TCCR2A, r17\nldi r17, 0x09\nsts TCCR2B, r17\n" +
            times(20, "nop\n") + "dec r16\nsts TCNT2, r16\nend: rjmp end\n");
    rig.run(kLong);
    const auto edges = rig.changes({PortLetter::D, 6});
    return edges.size() == 2 ? static_cast<int>(edges[1] - edges[0]) : -static_cast<int>(edges.size());
}

std::vector<std::pair<int, cosim::UartFrame>> sent_early(int bytes) {
    std::string source = "ldi r16, 72\n";
    source += times(bytes, "sts 0xC6, r16\ninc r16\n");
    source += "ldi r16, 3\nsts 0xC4, r16\nldi r16, 0x08\nsts 0xC1, r16\nend: rjmp end\n";
    Rig rig(source);
    rig.run(kLong);
    return rig.frames;
}

/// As the published loop compiles: a pin is high from before the byte is written until it has come in.
int usart_spi_byte() {
    Rig rig(R"(
        sbi DDRB, 0
        ldi r16, 0x18
        out DDRD, r16
        eor r1, r1
        sts 0xCC, r1
        sts 0xCD, r1
        ldi r16, 0xC0
        sts 0xCA, r16
        ldi r16, 0x18
        sts 0xC9, r16
        sts 0xCC, r1
        ldi r24, 0xAA
next:   sbi PORTB, 0
empty:  lds r25, 0xC8
        sbrs r25, 5
        rjmp empty
        sts 0xCE, r24
come:   lds r25, 0xC8
        sbrs r25, 7
        rjmp come
        cbi PORTB, 0
        lds r20, 0xCE
        rjmp next
)");
    rig.run(2000);
    const auto edges = rig.changes({PortLetter::B, 0});
    REQUIRE(edges.size() > 20);
    return static_cast<int>(edges[11] - edges[10]);  // up in even places
}

const std::string kSpiMaster = "ldi r16, 0xB0\nout DDRB, r16\nldi r16, 0x50\nout SPCR, r16\nldi r16, 1\n"
                               "out SPSR, r16\nldi r16, 0x55\nldi r20, 0x0F\nout SPDR, r16\n";

/// The rig's slave answers each byte with its complement.
int spi_read(int clocks) {
    return left(kSpiMaster + times(clocks - 1, "nop\n") + "in r17, SPDR\n");
}

/// The second byte as it went out; -1: it did not.
int spi_write(int clocks) {
    Rig rig(kSpiMaster + times(clocks - 1, "nop\n") + "out SPDR, r20\nend: rjmp end\n");
    rig.run(kLong);
    return rig.exchanges.size() < 2 ? -1 : rig.exchanges[1].first;
}

int ubrr_high_nibble() {
    const auto first_bit = [](const std::string& high) {
        Rig rig("ldi r16, " + high +
                "\nsts 0xC5, r16\nldi r16, 3\nsts 0xC4, r16\nldi r16, 0x08\nsts 0xC1, r16\n"
                "sts 0xC6, r16\nend: rjmp end\n");
        rig.run(kLong);
        REQUIRE(rig.frames.size() == 1);
        return rig.frames[0].second.bit_period;
    };
    return first_bit("0xF0") == first_bit("0x00") ? 0 : 1;
}

int adc_disabled(const std::string& read) {
    return left("ldi r16, 0x40\nsts 0x7C, r16\nldi r16, 0x47\nsts 0x7A, r16\n" + times(30, "nop\n") + read);
}

int sei_sleep_cli() {
    Rig rig(R"(
        jmp start
        .org 0x04           ; INT0
        inc r17
        reti
        .org 0x80
start:  ldi r16, 0x40
        out 0x3E, r16
        ldi r16, 3          ; rising edge of INT0
        sts 0x69, r16
        ldi r16, 1
        out 0x1C, r16
        out 0x1D, r16
        eor r17, r17
        sbi DDRD, 2
        sbi PORTD, 2        ; INT0's own pin: the edge
        nop
        nop
        nop
        ldi r16, 1          ; SE, idle
        out 0x33, r16
        sei
        sleep
        cli
        sts 0x100, r17
end:    rjmp end
)");
    rig.run(kLong);
    return rig.ram(0x100);
}

/// INT0 as a level that stays: instructions of the main program, counted by a row of INCs, for each routine.
int level_interrupt() {
    Rig rig("jmp start\n.org 0x04\njmp routine\n.org 0x80\n"
            "start: ldi r16, 0x40\nout 0x3E, r16\neor r17, r17\neor r18, r18\nldi r16, 1\nout 0x1D, "
            "r16\nsei\nnop\n" +
            times(40, "inc r17\n") +
            "cli\nsts 0x100, r17\nsts 0x101, r18\nend: rjmp end\nroutine: inc r18\nreti\n");
    rig.set_pin({PortLetter::D, 2}, false);
    rig.run(kLong);
    const int main = rig.ram(0x100), routines = rig.ram(0x101);
    // One more at either end at most.
    return main == 40 && routines >= main && routines <= main + 2 ? 1 : -routines;
}

/// Milliseconds from the program's start to the watchdog's reset, which began with 8 s; 0: none came.
int watchdog_shortened() {
    Rig rig("ldi r16, 0x18\nsts 0x60, r16\nldi r16, 0x29\nsts 0x60, r16\nldi r16, 0x18\nsts 0x60, r16\n"
            "ldi r16, 0x08\nsts 0x60, r16\nend: rjmp end\n");
    constexpr Cycle kMillisecond = 16'000;
    rig.run(30 * kMillisecond);
    for (const ResetRecord& reset : rig.chip.report().resets)
        if (reset.cause == ResetCause::Watchdog)
            return static_cast<int>((reset.cycle + kMillisecond / 2) / kMillisecond);
    return 0;
}

/// Resets after the two writes by which a boot loader switches the watchdog off.
int watchdog_off() {
    Rig rig("ldi r16, 0x18\nsts 0x60, r16\nldi r16, 0x08\nsts 0x60, r16\nldi r16, 0x18\nsts 0x60, r16\n"
            "eor r16, r16\nsts 0x60, r16\nend: rjmp end\n");
    rig.run(1'000'000);
    return static_cast<int>(rig.chip.report().resets.size()) - 1;  // power-on
}

/// A program whose interrupt at `vector` counts in r17, which is left at 0x100 when `set_up` and 60,000
/// clocks are over.
Rig counting(int vector, const std::string& set_up, const ChipOptions& options = {}) {
    return Rig("jmp start\n.org " + std::to_string(vector) +
                   "\ninc r17\nreti\n.org 0x80\nstart: ldi r16, 0x40\nout 0x3E, r16\neor r17, r17\n" +
                   set_up +
                   "sei\nldi r24, 0\nldi r25, 100\nagain: sbiw r24, 1\nbrne again\nldi r24, 0\nldi r25, 100\n"
                   "more: sbiw r24, 1\nbrne more\nsts 0x100, r17\nend: rjmp end\n",
               options);
}

/// The watchdog's interrupt without its reset, at the first of its periods (16 ms), within 100 ms.
int watchdog_interrupts() {
    Rig rig(
        "jmp start\n.org 0x20\nlds r17, 0x100\ninc r17\nsts 0x100, r17\nreti\n.org 0x80\n"
        "start: ldi r16, 0x40\nout 0x3E, r16\neor r17, r17\nsts 0x100, r17\nldi r16, 0x18\nsts 0x60, r16\n"
        "ldi r16, 0x40\nsts 0x60, r16\nsei\nend: rjmp end\n");
    rig.run(1'600'000);
    return rig.ram(0x100) == 6 && rig.chip.report().resets.size() == 1 ? 1 : 0;
}

const std::string kTwiStart = "ldi r16, 0xA4\nsts 0xBC, r16\nwait: lds r17, 0xBC\nsbrs r17, 7\nrjmp wait\n";

int twi_status() {
    return left(kTwiStart + "lds r17, 0xB9\n");
}

int twi_stop_bit() {
    return left(kTwiStart + "ldi r16, 0x94\nsts 0xBC, r16\nldi r18, 200\nbusy: dec r18\nbrne busy\n"
                            "lds r17, 0xBC\nandi r17, 0x10\n");
}

/// The converter's interrupts from one SLEEP in noise reduction, without ADSC.
int adc_by_sleep() {
    Rig rig("jmp start\n.org 0x60\ninc r17\nreti\n.org 0x80\nstart: ldi r16, 0x40\nout 0x3E, r16\n"
            "eor r17, r17\nldi r16, 0x8F\nsts 0x7A, r16\nldi r16, 3\nout 0x33, r16\nsei\nsleep\n"
            "sts 0x100, r17\nend: rjmp end\n");
    rig.run(kLong);
    return rig.ram(0x100);
}

/// Free running: whether more than one conversion comes of one ADSC.
int adc_free_running() {
    Rig rig = counting(0x60, "ldi r16, 0\nsts 0x7B, r16\nldi r16, 0xEF\nsts 0x7A, r16\n");
    rig.run(60'000 * 4);
    return rig.ram(0x100) > 1 ? 1 : 0;
}

/// Pin change interrupts of a pin that is an input, while a compare unit wants to drive it.
int pin_change_by_compare() {
    Rig rig = counting(
        0x10, "ldi r16, 0x10\nsts 0x6B, r16\nldi r16, 1\nsts 0x68, r16\nldi r16, 50\n"
              "out 0x27, r16\nout 0x28, r16\nldi r16, 0x12\nout 0x24, r16\nldi r16, 1\nout 0x25, r16\n");
    rig.run(60'000 * 4);
    return rig.ram(0x100);
}

/// INT0 at its rising edge, the pin high for the rest of the time.
int held_edge() {
    Rig rig = counting(0x04, "ldi r16, 3\nsts 0x69, r16\nldi r16, 1\nout 0x1D, r16\n");
    rig.set_pin({PortLetter::D, 2}, false);
    rig.run(1'000);
    rig.set_pin({PortLetter::D, 2}, true);
    rig.run(60'000 * 4);
    return rig.ram(0x100);
}

/// 0x0F, then 0xF0: "write only" with EEMPE, no mode with EEPE.
int eeprom_mode() {
    const std::string busy = ": sbic 0x1F, 1\nrjmp ";
    Rig rig("ldi r16, 0x10\nout 0x21, r16\neor r16, r16\nout 0x22, r16\nldi r16, 0x0F\nout 0x20, r16\n"
            "ldi r17, 0x04\nldi r18, 0x02\nldi r19, 0x24\nout 0x1F, r17\nout 0x1F, r18\nfirst" +
            busy + "first\nldi r16, 0xF0\nout 0x20, r16\nout 0x1F, r19\nout 0x1F, r18\nsecond" + busy +
            "second\nend: rjmp end\n");
    rig.run(200'000);
    return rig.chip.eeprom()[0x10];
}

const std::map<std::string, std::function<int()>>& programs() {
    static const std::map<std::string, std::function<int()>> all{
        {"tcnt0-out-in", [] { return count_after_out("0", ""); }},
        {"tcnt0-out-nop-in", [] { return count_after_out("48", "nop\n"); }},
        {"tcnt2-start-lds", [] { return count_after_start(""); }},
        {"tcnt2-start-nop-lds", [] { return count_after_start("nop\n"); }},
        {"tcnt2-start-stop", [] { return count_after_start("sts TCCR2B, r1\nnop\nnop\n"); }},
        {"one-shot-1", [] { return one_shot(1); }},
        {"one-shot-7", [] { return one_shot(7); }},
        {"one-shot-200", [] { return one_shot(200); }},
        {"udr-before-txen", [] { return static_cast<int>(sent_early(1).size()); }},
        {"udr-twice-before-txen", [] { return static_cast<int>(sent_early(3).size()); }},
        {"udr-last-before-txen",
         [] {
             const auto frames = sent_early(3);
             return frames.empty() ? -1 : static_cast<int>(frames[0].second.data);
         }},
        {"usart-spi-byte", usart_spi_byte},
        {"ubrr-high-nibble", ubrr_high_nibble},
        {"spi-read-16", [] { return spi_read(16); }},
        {"spi-read-17", [] { return spi_read(17); }},
        {"spi-write-17", [] { return spi_write(17); }},
        {"spi-write-18", [] { return spi_write(18); }},
        {"adc-disabled", [] { return adc_disabled("lds r17, 0x78\nlds r16, 0x79\nor r17, r16\n"); }},
        {"adc-disabled-adsc", [] { return adc_disabled("lds r17, 0x7A\nandi r17, 0x40\n"); }},
        {"sei-sleep-cli", sei_sleep_cli},
        {"level-interrupt", level_interrupt},
        {"wdt-shortened", [] { return watchdog_shortened() == 16 ? 1 : 0; }},
        {"wdt-off", watchdog_off},
        {"wdt-interrupts", watchdog_interrupts},
        {"twi-status", twi_status},
        {"twi-stop-bit", twi_stop_bit},
        {"adc-by-sleep", adc_by_sleep},
        {"adc-free-running", adc_free_running},
        {"pcint-compare", pin_change_by_compare},
        {"int0-held", held_edge},
        {"eeprom-mode", eeprom_mode},
    };
    return all;
}

}  // namespace

TEST_CASE("each published measurement is what our part shows") {
    std::ifstream in(AVR_MEASURED);
    REQUIRE(in);
    std::string line;
    std::getline(in, line);  // names of the columns
    std::set<std::string> seen;
    while (std::getline(in, line)) {
        const auto cells = csv_cells(line, ',');
        REQUIRE(cells.size() == 5);
        const std::string id(cells[0]);
        INFO(id << ": " << cells[3] << " (" << cells[2] << ", " << cells[4] << ")");
        REQUIRE(programs().contains(id));
        seen.insert(id);
        CHECK(programs().at(id)() == std::stoi(std::string(cells[1])));
    }
    CHECK(seen.size() == programs().size());
}
