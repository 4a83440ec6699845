// A TAM's board with what saves executing instructions, and without: the same bytes, signals and saved state,
// for random stimuli. Real images (PUCKLOOP_IMAGES) and the own firmware.

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

void check(const image::AvrImage& image, Time longest, const std::string& name) {
    INFO(name);
    RandomStream random(21, name);
    const BoardParameters parameters;  // with noise
    const auto fast = std::make_unique<Rig>(parameters), slow = std::make_unique<Rig>(parameters);
    for (Rig* rig : {fast.get(), slow.get()})
        rig->board.load(image);
    slow->board.chip().set_skipping(false);
    for (Time now = 0; now < longest;) {
        const Time until = now + 1 + static_cast<Time>(random.below(60 * cosim::kMillisecond));
        const Stretch stretch = random_stretch(random, now, until, random.below(2) ? 150 : 3);
        apply(fast->board, stretch);
        apply(slow->board, stretch);
        now = until;
        INFO("until " << cosim::to_seconds(now) << " s");
        const bool same = saved(fast->board) == saved(slow->board);
        REQUIRE(same);
    }
    CHECK(same_output(*fast, *slow));
    // The own firmware sleeps instead.
    if (name.starts_with("tam_"))
        CHECK(fast->board.chip().report().skipped > fast->board.chip().report().cycles / 2);
    CHECK(slow->board.chip().report().skipped == 0);
}

}  // namespace

#ifdef TAM_FIRMWARE
TEST_CASE("the own TAM firmware does the same on every path") {
    check(image::load_avr_image(TAM_FIRMWARE, avr::atmega1284p().image_part()), 4 * cosim::kSecond, "own");
}
#endif

TEST_CASE("real TAM images do the same on every path", "[images]") {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    int found = 0;
    if (folder)
        for (const char* name :
             {"tam_firmware.elf", "tam_test_barriers.elf", "tam_test_basics.elf", "tam_test_ircom.elf",
              "tam_test_leds.elf", "tam_test_production.elf", "tam_test_proximity.elf",
              "tam_test_voltage.elf", "tam_test_xbee.elf", "optiboot_atmega1284p.hex"}) {
            const std::string path = std::string(folder) + "/" + name;
            if (!std::filesystem::exists(path)) continue;
            ++found;
            check(image::load_avr_image(path, avr::atmega1284p().image_part()), 2 * cosim::kSecond, name);
        }
    if (found == 0) WARN("PUCKLOOP_IMAGES has no TAM images: skipped");
}
