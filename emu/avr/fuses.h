#pragma once
// Fuse and lock bytes and what they mean. Source: data sheet 8272, "Memory Programming".

#include <cstdint>

namespace puckloop::avr {

struct Fuses {
    std::uint8_t low = 0x62, high = 0x99, extended = 0xFF;  ///< as shipped; a programmed bit is 0
    std::uint8_t lock = 0xFF;

    constexpr bool boot_reset() const { return !(high & 1u); }  ///< BOOTRST: reset leads to the boot section
    constexpr bool watchdog_always() const { return !(high & 0x10u); }  ///< WDTON
    constexpr bool keep_eeprom() const { return !(high & 0x08u); }      ///< EESAVE
    constexpr bool divide_clock() const { return !(low & 0x80u); }      ///< CKDIV8
    constexpr bool jtag() const { return !(high & 0x40u); }             ///< JTAGEN
    /// BOOTSZ: 512, 1024, 2048 or 4096 words at the end of the flash.
    constexpr std::uint32_t boot_words() const { return 4096u >> (high >> 1 & 3u); }

    /// BODLEVEL: the supply below which the brown-out detector holds the chip in reset; 0 volts: it is off.
    constexpr double brown_out_volts() const {
        constexpr double kVolts[] = {0, 0, 0, 0, 4.3, 2.7, 1.8, 0};  // 000 to 011 are reserved
        return kVolts[extended & 7u];
    }

    template <class Archive>
    void state(Archive& archive) {
        archive(low, high, extended, lock);
    }
};

}  // namespace puckloop::avr
