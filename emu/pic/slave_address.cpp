#include "emu/pic/slave_address.h"

#include "base/error.h"
#include "emu/image/image.h"

#include <algorithm>

namespace puckloop::pic {

namespace {

constexpr std::uint32_t kI2cadd = 0x020A;

/// Encodings: dsPIC30F/33F Programmer's Reference Manual, section 5.
bool writes_address(std::uint32_t word) {
    const bool from_register = (word & 0xFFFFF0) == (0x880000 | kI2cadd >> 1 << 4);  // mov Wn, f
    const bool from_wreg = (word & 0xFFBFFF) == (0xB7A000 | kI2cadd);                // mov{.b} WREG, f
    const bool sets_bit = (word & 0xFF1FFE) == (0xA80000 | kI2cadd);                 // bset f, #n
    return from_register || from_wreg || sets_bit;
}

}  // namespace

bool sets_slave_address(const std::string& file) {
    try {
        const image::Image image = image::load_image(file);
        return std::any_of(image.program.begin(), image.program.end(),
                           [](const auto& word) { return writes_address(word.second); });
    } catch (const InputError&) {
        return false;  // the board's node names what is wrong
    }
}

}  // namespace puckloop::pic
