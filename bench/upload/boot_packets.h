#pragma once
// What the e-puck's resident boot loader (Tiny Bootloader for the dsPIC30F6014A, from 0x17F40 on) is sent.
// Source: tool/bootloader/epuck_side of the e-puck library, its source and images.
//
// It waits for C1 for about a second after a reset and answers 71 4B. A row is address (16 bits, low octet
// first), upper octet of the address, a count, 32 words of three octets and a check that makes the sum of all
// 0; the answer is 4B, or 4E if the sum is wrong. An address whose fourth octet is FF ends: the program
// starts.

#include "emu/image/image.h"

#include <cstdint>
#include <vector>

namespace puckloop::tools {

inline constexpr std::uint8_t kBootHello = 0xC1, kBootChip = 0x71, kBootOk = 0x4B, kBootWrong = 0x4E;
inline constexpr std::uint32_t kBootEntry = 0x17F40, kBootReturn = 0x17F38, kBootRow = 0x17F00;

using BootPacket = std::vector<std::uint8_t>;

/// The rows of a program, the first one last: an upload that breaks off leaves a robot that still starts as
/// before. Reset leads to the boot loader, and from there to where the image's own reset led. Configuration
/// words and EEPROM stay on the robot. Throws InputError for an image that lies over the boot loader or whose
/// reset is no goto.
std::vector<BootPacket> boot_packets(const image::Image& image);

/// The last packet; `ticks` of 13 ms the LED shines before the program starts.
BootPacket boot_end(std::uint16_t ticks = 20);

}  // namespace puckloop::tools
