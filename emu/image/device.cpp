#include "emu/image/device.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace puckloop::image {

namespace {

constexpr AddressRange kRanges30F6014A[] = {
    {0x000000, 0x00007E, "reset vector and interrupt vectors"},
    {0x000084, 0x0000FE, "alternate interrupt vectors"},
    {0x000100, 0x017FFE, "user flash"},
    {0x7FF000, 0x7FFFFE, "data EEPROM"},
    {0x800000, 0x8005BE, "executive memory"},
    {0x8005C0, 0x8005FE, "unit identification"},
    {0xF80000, 0xF8000C, "configuration registers"},
    {0xFF0000, 0xFF0002, "device identification"},
};

constexpr AddressRange kRanges33FJ256GP710[] = {
    {0x000000, 0x0000FE, "reset vector and interrupt vectors"},
    {0x000104, 0x0001FE, "alternate interrupt vectors"},
    {0x000200, 0x02ABFE, "user flash"},
    {0xF80000, 0xF80016, "configuration registers"},
    {0xFF0000, 0xFF0002, "device identification"},
};

constexpr std::uint32_t kErased = 0xFFFFFF;
constexpr std::uint32_t kErasedData = 0x00FFFF;

bool is_erased(std::uint32_t address, std::uint32_t word) {
    return word == kErased || (address >= 0x7FF000 && word == kErasedData);
}

const Device* const kDevices[] = {&kDspic30F6014A, &kDspic33FJ256GP710};

}  // namespace

const Device kDspic30F6014A{"dspic30f6014a", "dsPIC30F6014A", kRanges30F6014A};
const Device kDspic33FJ256GP710{"dspic33fj256gp710", "dsPIC33FJ256GP710", kRanges33FJ256GP710};

const Device& find_device(std::string_view name) {
    std::string lower(name);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::string known;
    for (const Device* device : kDevices) {
        if (lower == device->name) return *device;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", device->name);
    }
    throw InputError("", "", fmt::format("unknown chip \"{}\"", name), known);
}

void check_fits(const Image& image, const Device& device) {
    if (!image.chip.empty() && image.chip != device.name)
        throw InputError(image.file, "", fmt::format("was built for another chip, {}", image.chip),
                         device.name);
    for (const auto& [address, word] : image.all_words()) {
        const bool inside =
            std::any_of(device.writable.begin(), device.writable.end(), [&](const AddressRange& range) {
                return address >= range.first && address <= range.last;
            });
        if (inside || is_erased(address, word)) continue;
        throw InputError(image.file, fmt::format("program address 0x{:06X}", address),
                         fmt::format("the {} has no memory there: an image for another chip?", device.title),
                         "addresses of the device's memory map");
    }
}

}  // namespace puckloop::image
