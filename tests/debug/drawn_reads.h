#pragma once
// Programs drawn at random that write and read RAM here and there, and what each of their reads finds: a byte
// that something wrote before, or one that nothing did.

#include "base/random.h"
#include "emu/dspic/devices/device.h"
#include "tests/crashes/crash_image.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::tests {

struct DrawnReads {
    struct Read {
        std::uint32_t pc = 0, address = 0;
        std::string variable;
        unsigned times = 0;
    };
    std::string elf;          ///< with names for some of the bytes
    std::vector<Read> reads;  ///< of bytes that nothing had written, by when they came first
    unsigned in_all = 0;
    std::uint32_t main = 0;  ///< program address of its only function

    /// Checks (Catch2) that "stats" of a report has these reads, and no other.
    void check(const nlohmann::json& stats) const;
};

/// Loads and stores of every kind, PUSH and POP, CALL and RET, a stack pointer that is moved, loops; EEPROM
/// and flash, which are no RAM, are read as well.
DrawnReads draw_avr_reads(RandomStream& random, const VariablesByName& more = {});
/// Words and bytes, read-modify-write, REPEAT, PUSH and POP, RCALL and RETURN.
DrawnReads draw_dspic_reads(RandomStream& random, const dspic::DeviceInfo& device);

}  // namespace puckloop::tests
