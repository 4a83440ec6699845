#pragma once
// One Linux node on a bench: the test plays the other ends of its serial port and its I2C bus.

#include "base/random.h"
#include "linuxboard/shim/node/linux_node.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tests {

/// Folder of the small programs of tests/linuxboard/programs, as built.
std::string program(const std::string& name);
/// A node's description: the program with its arguments, and a log file of its own.
linuxboard::LinuxSpec spec_for(const std::string& name, std::vector<std::string> args = {});

class Bench {
  public:
    /// Time is granted in steps of `slice`, at most 78 us so that nothing can be answered within one.
    /// (without frames on the line it does not matter). `scenery`: for the spec's cameras.
    explicit Bench(linuxboard::LinuxSpec spec, cosim::Time slice = 70 * cosim::kMicrosecond,
                   std::unique_ptr<linuxboard::Scenery> scenery = nullptr);
    ~Bench();
    Bench(const Bench&) = delete;
    Bench& operator=(const Bench&) = delete;

    /// A byte arrives at 115200 8N1, its start bit at `start`.
    void send(cosim::Time start, std::uint8_t byte, double baud = 115'200.0);
    void send(cosim::Time start, const std::string& bytes);
    /// A device on the bus whose first written byte is a register number that counts up.
    void add_device(std::uint8_t address, std::map<std::uint8_t, std::uint8_t> registers);
    /// A signal at the port `camera`.
    void change(cosim::Time time, std::uint16_t id, double value);
    /// Called for every byte that the program sends.
    std::function<void(cosim::Time, std::uint8_t)> on_byte;

    /// Before each step the node runs ahead on what it makes up, as far as it can, and goes back.
    void make_up(std::uint64_t seed) { made_up_.emplace(seed, "made up"); }

    /// Runs until `end` or until the node wants the run to end; with `past_stop` even then.
    void run(cosim::Time end, bool past_stop = false);

    linuxboard::LinuxNode& node() { return node_; }
    /// All messages that left the node, as text.
    const std::string& trace() const { return trace_; }
    const std::string& sent() const { return sent_; }
    std::string log() const;
    cosim::Time now() const { return now_; }

  private:
    void answer_i2c(const cosim::I2cPhase& phase);
    void queue(cosim::Message message);
    void run_ahead_in_vain();

    /// Removed behind the node, whose end writes into it.
    struct LogFile {
        std::string path;
        ~LogFile();
    };

    linuxboard::LinuxSpec spec_;
    LogFile log_file_;
    linuxboard::LinuxNode node_;
    cosim::Time slice_;
    cosim::Time now_ = 0;
    std::vector<cosim::Message> pending_;
    std::map<std::uint8_t, std::map<std::uint8_t, std::uint8_t>> devices_;
    std::optional<RandomStream> made_up_;
    std::uint8_t address_ = 0;
    std::uint8_t register_ = 0;
    bool register_set_ = false;
    std::string trace_;
    std::string sent_;
};

}  // namespace puckloop::tests
