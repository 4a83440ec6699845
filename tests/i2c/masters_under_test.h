#pragma once
// Masters of one bus with programs that do the same transfer: a dsPIC, an AVR, a Linux adapter. What each
// sends and is answered is recorded.

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::tests {

/// One part of a transfer, from START or repeated START on.
struct TransferPart {
    bool read = false;
    std::vector<std::uint8_t> bytes{};  ///< written; for a read only their number counts
};

using Transfer = std::vector<TransferPart>;

constexpr std::uint8_t kSharedDevice = 0x20;

/// A byte with its ninth clock, or a STOP, as a master gives it.
struct BusUnit {
    enum class Kind : std::uint8_t { Address, Write, Read, Stop } kind = Kind::Stop;
    std::uint8_t byte = 0;  ///< of Address and Write
    bool ack = false;       ///< of Read
};

std::vector<BusUnit> units_of(const Transfer& transfer);

enum class MasterKind : std::uint8_t { Dspic, Avr, Linux };

struct MasterUnderTest {
    MasterKind kind = MasterKind::Linux;
    Transfer transfer;
    cosim::Time delay = 0;                 ///< before its START, beside what its program needs anyway
    bool halts = false;                    ///< of a dsPIC: its program stops behind the address
    cosim::Time timeout = cosim::kSecond;  ///< of a Linux adapter

    // after run_masters()
    struct Row {
        cosim::Time time = 0;
        cosim::I2cPhase phase;
    };
    std::vector<Row> sent{}, answered{};
    int units_done = 0;
    bool lost = false;                     ///< as its program sees it: BCL, status 0x38, EAGAIN
    int error = 0;                         ///< of a Linux adapter
    std::vector<std::uint8_t> statuses{};  ///< TWSR of an AVR
    std::string read{};                    ///< by the Linux adapter
};

struct MastersRun {
    std::vector<std::uint8_t> written;  ///< what the device got
    std::string report;                 ///< of the bus
    std::string sha;
};

/// All of them on one bus of 100 kHz with a device at kSharedDevice that acknowledges what is written and
/// sends 0x11, 0x12, ... `chop`: cuts grants at random.
MastersRun run_masters(std::vector<MasterUnderTest>& masters, std::uint64_t chop = 0);

}  // namespace puckloop::tests
