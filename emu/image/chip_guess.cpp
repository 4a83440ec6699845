#include "emu/image/chip_guess.h"

#include "base/error.h"
#include "emu/image/avr_image.h"
#include "emu/image/coff.h"
#include "emu/image/device.h"
#include "emu/image/elf_file.h"
#include "emu/image/image_file.h"
#include "emu/image/intel_hex.h"

#include <algorithm>

namespace puckloop::image {

namespace {

constexpr AvrPart kAvr{"atmega1284p", 51, 0x20000, 0x1000};

/// The fourth byte of each program word of a dsPIC is not there: Microchip's HEX has 0 in its place, or FF
/// where words of memory that was read back are erased.
bool has_phantom_bytes(const std::vector<ByteSegment>& segments) {
    constexpr std::uint64_t kWord = 4, kErased = 0xFF;
    return std::all_of(segments.begin(), segments.end(), [](const ByteSegment& segment) {
        for (std::size_t i = 0; i < segment.bytes.size(); ++i)
            if ((segment.address + i) % kWord == kWord - 1 && segment.bytes[i] != 0 &&
                segment.bytes[i] != kErased)
                return false;
        return true;
    });
}

bool fits(const Image& image, const Device& device) {
    try {
        check_fits(image, device);
        return true;
    } catch (const InputError&) {
        return false;
    }
}

bool fits_avr(const std::string& bytes, const std::string& path) {
    try {
        parse_avr_image(bytes, path, kAvr);
        return true;
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace

std::vector<std::string> chips_that_fit(const std::string& path) {
    const std::string bytes = read_image_file(path);
    std::vector<std::string> chips;
    const bool avr_elf = is_elf(bytes) && elf_machine(bytes) == kMachineAvr;
    const bool avr_hex =
        looks_like_hex(bytes) && !is_elf(bytes) && !has_phantom_bytes(parse_intel_hex(bytes, path));
    if (avr_elf || avr_hex) {
        if (fits_avr(bytes, path)) chips.emplace_back(kAvr.name);
        return chips;
    }
    const Image image = parse_image(bytes, path);
    for (const Device* device : {&kDspic30F6014A, &kDspic33FJ256GP710})
        if (fits(image, *device)) chips.emplace_back(device->name);
    return chips;
}

bool looks_like_image(const std::string& path) {
    try {
        const std::string bytes = read_image_file(path);
        return is_elf(bytes) || is_coff(bytes) ||
               (looks_like_hex(bytes) && !parse_intel_hex(bytes, path).empty());
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace puckloop::image
