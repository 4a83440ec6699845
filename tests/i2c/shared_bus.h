#pragma once
// A bus with two masters and boards in nodes of their own, run by the conductor.

#include "cosim/conductor.h"
#include "emu/i2c_devices/bus_node.h"
#include "linuxboard/shim/devices/i2c_adapter.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::tests {

/// What a master is to do, and when it is asked to.
struct Task {
    cosim::Time time = 0;
    linuxboard::I2cTransfer transfer;
};

/// A board with 256 registers behind a pointer, that answers as late as it is set to.
struct Board {
    std::uint8_t address = 0x20;
    std::uint8_t fill = 0x5A;                     ///< what its registers hold at first
    cosim::Time stretch = 0;                      ///< of every byte written to it
    cosim::Time hold = 0;                         ///< of one byte:
    int hold_byte = -1;                           ///< the so-manieth written, 0 the first
    cosim::Time off_until = 0;                    ///< acknowledges nothing before
    std::map<std::uint8_t, std::uint8_t> seen{};  ///< register -> what was written there last
};

struct SharedBus {
    std::vector<Task> pic, linux_board;
    /// Assembler source: the master "pic" is a main board with this program in place of the list, and a
    /// device too.
    std::string main_board{};
    std::string rab_board{};  ///< the same for a range-and-bearing board, which is a device only
    std::vector<Board> boards;
    bool ground_sensor = false;
    std::vector<cosim::FaultSpec> faults{};
    std::uint64_t seed = 1;
    double hertz = 100e3;
    cosim::Time duration = 100 * cosim::kMillisecond;

    // after run()
    std::vector<linuxboard::I2cResult> pic_results, linux_results;
    std::string report;                            ///< of the bus
    std::string pic_report;                        ///< of the main board
    std::map<std::string, std::uint16_t> words{};  ///< of its data memory, by the names of `watched`
    std::vector<std::pair<std::string, std::uint16_t>> watched{};
    std::string sha;

    /// Several times, with grants cut differently each time; checks that nothing depends on that.
    void run();

  private:
    void run_once(std::optional<std::uint64_t> chop);
};

/// write of `bytes` to `address`.
linuxboard::I2cTransfer writing(std::uint16_t address, std::string bytes);
/// One register, as ARGoS and i2c-tools would in one transfer: write the number, repeated START, read.
linuxboard::I2cTransfer reading(std::uint16_t address, std::uint8_t number, std::uint16_t count = 1);

}  // namespace puckloop::tests
