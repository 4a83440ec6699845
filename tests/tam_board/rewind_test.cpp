// A TAM's board that ran ahead and went back is the board that never did, and one that was saved and loaded
// goes on as the other. Real images (PUCKLOOP_IMAGES), own firmware, and a program that writes its own flash.

#include "base/states/checkpoint.h"
#include "tests/tam_board/stimuli.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <memory>

using namespace puckloop;
using namespace puckloop::tam;
using namespace puckloop::tam::test;
using cosim::Time;

namespace {

/// Writes a page of the application section again and again, each time another word in it that the main
/// program executes; the EEPROM counts. It is in the boot section.
const char* const kWritesItself = R"(
        .org 0x1FC00
start:  ldi  r16, 1
        out  RAMPZ, r16
        ldi  r24, 0
again:  inc  r24
        ldi  r30, 0x00
        ldi  r31, 0x10      ; byte address 0x11000
        ldi  r18, 0x03
        rcall command       ; erase
        mov  r0, r24        ; ldi r16, <r24>: 1110 KKKK 0000 KKKK
        ldi  r19, 0x0F
        and  r0, r19
        mov  r1, r24
        swap r1
        and  r1, r19
        ldi  r19, 0xE0
        or   r1, r19
        ldi  r18, 0x01
        rcall command       ; ldi
        ldi  r19, 0x08
        mov  r0, r19
        ldi  r19, 0x95
        mov  r1, r19
        ldi  r30, 0x02
        rcall command       ; ret
        ldi  r30, 0x00
        ldi  r18, 0x05
        rcall command       ; write
        ldi  r18, 0x11
        rcall command       ; the section again
        call 0x11000
        out  GPIOR0, r16
        out  EEARL, r24
        out  EEDR, r16
        sbi  EECR, 2
        sbi  EECR, 1
        sbi  PINC, 3
        sbi  DDRC, 3
        rjmp again
command:
        out  SPMCSR, r18
        spm
busy:   in   r17, SPMCSR
        sbrc r17, 0
        rjmp busy
        ret
)";

struct Run {
    int marks = 0;
    Time between = 0;   ///< longest time from one mark to the next
    Time ahead = 0;     ///< longest time run ahead
    double busy = 100;  ///< stimuli a second
};

image::AvrImage with_boot_reset(image::AvrImage image) {
    image.fuses = {0xFF, 0xDE, 0xFD};
    return image;
}

Time within(RandomStream& random, Time longest) {
    return 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(longest)));
}

void check(const image::AvrImage& image, const Run& run, const std::string& name) {
    INFO(name);
    RandomStream random(5, name);
    BoardParameters parameters;  // with noise
    const auto twin = std::make_unique<Rig>(parameters), rig = std::make_unique<Rig>(parameters);
    twin->board.load(image);
    rig->board.load(image);
    Checkpoint checkpoint;
    for (int i = 0; i < run.marks; ++i) {
        const Time now = twin->board.now();
        INFO("mark " << i << " at " << cosim::to_seconds(now) << " s");
        rig->board.mark();
        checkpoint.take(rig->board);
        for (std::uint64_t times = random.below(3); times > 0; --times) {
            Time ahead = now;
            for (std::uint64_t steps = 1 + random.below(3); steps > 0; --steps) {
                const Time until = ahead + within(random, run.ahead);
                apply(rig->board, random_stretch(random, ahead, until, run.busy));
                ahead = until;
            }
            rig->board.rewind();
            checkpoint.restore(rig->board);
            const bool same_bytes = saved(rig->board) == saved(twin->board);
            REQUIRE(same_bytes);
        }
        if (random.below(2) == 0) rig->board.settle();
        rig->changes = twin->changes;
        rig->frames = twin->frames;
        rig->phases = twin->phases;
        const Stretch stretch = random_stretch(random, now, now + within(random, run.between), run.busy);
        apply(rig->board, stretch);
        apply(twin->board, stretch);
        REQUIRE(same_output(*rig, *twin));
        const auto bytes = saved(twin->board);
        const bool same_bytes = saved(rig->board) == bytes;
        REQUIRE(same_bytes);
        if (i % 10 == 9) {  // another board takes over from the saved bytes
            auto other = std::make_unique<Rig>(parameters);
            other->board.load(image);
            StateReader reader(bytes);
            other->board.state(reader);
            const bool loaded = saved(other->board) == bytes;
            REQUIRE(loaded);
            const Time later = twin->board.now() + run.between;
            const Stretch both = random_stretch(random, twin->board.now(), later, run.busy);
            apply(other->board, both);
            apply(twin->board, both);
            apply(rig->board, both);
            const bool same = saved(other->board) == saved(twin->board);
            REQUIRE(same);
        }
    }
}

}  // namespace

TEST_CASE("a program that writes its own flash and EEPROM goes back") {
    check(with_boot_reset(assembled(kWritesItself)),
          {.marks = 150, .between = 6 * cosim::kMillisecond, .ahead = 12 * cosim::kMillisecond}, "itself");
    // It does what it is there for.
    Rig rig;
    rig.board.load(with_boot_reset(assembled(kWritesItself)));
    rig.board.run_until(100 * cosim::kMillisecond);
    CHECK(rig.board.chip().peek("GPIOR0") > 8);
    CHECK(rig.board.chip().eeprom()[5] == 5);
}

#ifdef TAM_FIRMWARE
TEST_CASE("the own TAM firmware goes back") {
    check(image::load_avr_image(TAM_FIRMWARE, avr::atmega1284p().image_part()),
          {.marks = 120, .between = 20 * cosim::kMillisecond, .ahead = 20 * cosim::kMillisecond}, "own");
}
#endif

TEST_CASE("real TAM images go back", "[images]") {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    int found = 0;
    if (folder)
        for (const char* name : {"tam_firmware.elf", "tam_test_ircom.elf", "tam_test_leds.elf",
                                 "tam_test_xbee.elf", "optiboot_atmega1284p.hex"}) {
            const std::string path = std::string(folder) + "/" + name;
            if (!std::filesystem::exists(path)) continue;
            ++found;
            check(image::load_avr_image(path, avr::atmega1284p().image_part()),
                  {.marks = 60,
                   .between = 25 * cosim::kMillisecond,
                   .ahead = 20 * cosim::kMillisecond,
                   .busy = 200},
                  name);
        }
    if (found == 0) WARN("PUCKLOOP_IMAGES has no TAM images: skipped");
}
