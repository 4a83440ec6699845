#pragma once
// An AVR firmware image: bytes of flash, EEPROM and fuses by byte address, from Intel HEX (where other
// memories than the flash have the addresses that avr-objcopy gives them) or from the ELF that avr-gcc
// writes. Source: avr-libc's linker scripts (flash at 0, RAM at 0x800000, EEPROM at 0x810000, fuses at
// 0x820000, lock bits at 0x830000, signature at 0x840000), binutils' elf/avr.h and gcc's device information
// note.

#include "emu/image/byte_segments.h"
#include "emu/image/image.h"
#include "emu/image/line_table.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::image {

struct AvrImage {
    std::string file;
    Format format = Format::IntelHex;
    std::string sha256;    ///< of the file's bytes, lower-case hexadecimal
    std::string chip;      ///< as the compiler noted it ("atmega1284p"), or empty
    int architecture = 0;  ///< avr-gcc's number, 51 for the ATmega1284P; 0 where the format does not say
    std::vector<ByteSegment> flash;
    std::vector<ByteSegment> eeprom;  ///< from address 0 on
    std::vector<std::uint8_t> fuses;  ///< low, high, extended; empty: not given
    std::optional<std::uint8_t> lock_bits;
    std::map<std::string, Symbol> symbols;  ///< Program: byte addresses of flash; Data: of the data space
    LineTable lines;                        ///< by byte address of flash; empty without debug information

    /// Byte address of a function or label.
    std::optional<std::uint32_t> find_code(std::string_view name) const;
};

/// What an image must fit: name, avr-gcc architecture, bytes of flash and EEPROM.
struct AvrPart {
    std::string_view name;
    int architecture = 0;
    std::uint32_t flash_bytes = 0;
    std::uint32_t eeprom_bytes = 0;
};

/// Throws InputError: an unreadable or damaged file, one for another part, bytes where the part has no
/// memory.
AvrImage load_avr_image(const std::string& path, const AvrPart& part);
/// The same for bytes already in memory; `file` is the name for messages.
AvrImage parse_avr_image(std::string_view bytes, const std::string& file, const AvrPart& part);
/// Flash, EEPROM, fuses and lock bits as Intel HEX; erased bytes are left out.
std::string write_avr_hex(const AvrImage& image);

}  // namespace puckloop::image
