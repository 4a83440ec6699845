#pragma once
// The chips an image may be for, and whether it fits. Source: fact sheet dspic/memory_map.csv.

#include "emu/image/image.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace puckloop::image {

/// Program addresses from `first` to `last`, both even, both included.
struct AddressRange {
    std::uint32_t first;
    std::uint32_t last;
    const char* what;
};

struct Device {
    const char* name;                        ///< as --mcu takes it
    const char* title;                       ///< as Microchip writes it
    std::span<const AddressRange> writable;  ///< what a programmer may program, sorted
};

extern const Device kDspic30F6014A;
extern const Device kDspic33FJ256GP710;

/// By --mcu name, any case. Throws InputError listing the known names.
const Device& find_device(std::string_view name);

/// Throws InputError when the image is for another chip: the compiler noted another one, or a word that is
/// not erased lies outside the device's ranges. (Memory read back from a chip may hold erased words
/// anywhere.)
void check_fits(const Image& image, const Device& device);

}  // namespace puckloop::image
