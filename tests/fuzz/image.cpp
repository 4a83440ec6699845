// Firmware images of the dsPICs: HEX, ELF and COFF, with their line tables.

#include "emu/image/image.h"
#include "base/error.h"
#include "emu/image/coff.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    const std::string_view bytes = text_of(input);
    try {
        image::parse_image(bytes, "fuzzed.hex");
        if (image::is_coff(bytes)) image::read_coff_lines(bytes, "fuzzed.hex");
    } catch (const InputError& error) {
        require_refusal(error.what(), "fuzzed.hex");
    }
}
