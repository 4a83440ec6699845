// Firmware images of the ATmega1284P.

#include "emu/image/avr_image.h"
#include "base/error.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    static constexpr image::AvrPart kPart{"ATmega1284P", 51, 128 * 1024, 4096};
    try {
        image::parse_avr_image(text_of(input), "fuzzed.elf", kPart);
    } catch (const InputError& error) {
        require_refusal(error.what(), "fuzzed.elf");
    }
}
