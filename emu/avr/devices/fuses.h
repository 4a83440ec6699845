#pragma once
// Fuse and lock bytes and what they mean. Source: data sheet 8272, "Memory Programming".

#include <cstdint>

namespace puckloop::avr {

/// How long a chip stays in reset once the cause of it is over.
struct StartUp {
    std::uint32_t clocks = 0;  ///< of the oscillator
    double seconds = 0;        ///< of the time-out that SUT selects, before them
};

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

    /// Clocks from power-down and power-save, by CKSEL3:0 and SUT1:0 (tables 9-2 to 9-13).
    constexpr std::uint32_t start_up_clocks() const {
        constexpr std::uint32_t kAtOnce = 6, kFast = 258, kThousand = 1024, kSlow = 16'384, kWatch = 32'768;
        if (clock_select() < 4) return kAtOnce;                                   // external clock, RC
        if (clock_select() < 6) return clock_select() == 5 ? kWatch : kThousand;  // low-frequency crystal
        if (crystal_code() < 2) return kFast;
        return crystal_code() < 5 ? kThousand : kSlow;
    }
    /// The same tables' additional delay from a reset: 14 clocks, and no time-out, 4.1 or 65 ms.
    constexpr StartUp reset_start_up() const {
        constexpr std::uint32_t kFromReset = 14;
        constexpr double kCrystal[] = {4.1e-3, 65e-3, 0, 4.1e-3, 65e-3, 0, 4.1e-3, 65e-3};
        constexpr double kOthers[] = {0, 4.1e-3, 65e-3, 65e-3};  // the last one is reserved
        return {start_up_clocks() + kFromReset,
                clock_select() < 6 ? kOthers[low >> 4 & 3u] : kCrystal[crystal_code()]};
    }

    template <class Archive>
    void state(Archive& archive) {
        archive(low, high, extended, lock);
    }

  private:
    constexpr unsigned clock_select() const { return low & 15u; }
    constexpr unsigned crystal_code() const { return (low & 1u) << 2 | (low >> 4 & 3u); }
};

}  // namespace puckloop::avr
