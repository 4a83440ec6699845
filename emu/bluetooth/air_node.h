#pragma once
// Bluetooth of a run as a node: the modules of all robots, the computers linked with them, and the air
// between them. One UART port for each, and the port "world", where positions come in.

#include "cosim/core/node.h"
#include "emu/bluetooth/computer.h"
#include "emu/bluetooth/module.h"
#include "emu/bluetooth/network.h"

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::bluetooth {

/// A robot's module. Its pose in the world begins at signal `pose` (x, y; m); -1: it has no place.
struct RobotModule {
    ModuleOptions module{};
    int pose = -1;
};

struct AirSpec {
    std::string name = "bluetooth";
    std::uint64_t seed = 1;
    Times times{};
    double range = 10.0;                 ///< m
    std::vector<RobotModule> modules{};  ///< ports by their names
    std::vector<ComputerOptions> computers{};
    std::string csv{};  ///< log of the air; empty: none
};

class AirNode : public cosim::Node {
  public:
    /// Throws InputError for numbers out of range, RunError if the log cannot be written.
    explicit AirNode(const AirSpec& spec);
    ~AirNode() override;

    std::string_view name() const override { return spec_.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    /// JSON: counts of the air, "modules": {name: counters}, "warnings".
    std::string finish() override;

    const Module& module(std::size_t number) const { return *modules_[number]; }
    const Computer& computer(std::size_t number) const { return *computers_[number]; }
    const Network& network() const { return network_; }

  private:
    struct Place {
        bool x_known = false, y_known = false;
        std::array<double, 2> at{};
    };
    void check() const;
    void run(cosim::Time until, bool inclusive);
    void receive(const cosim::Message& message);
    void receive_frame(std::size_t port, const cosim::UartFrame& frame);
    void place(const cosim::Signal& signal, cosim::Time now);
    SerialOut& serial(std::size_t port);
    const SerialOut& serial(std::size_t port) const;
    void write(cosim::Time at, std::string_view who, std::string_view what, std::string_view whom,
               cosim::Time since);

    AirSpec spec_;
    std::vector<cosim::Port> ports_;
    std::FILE* log_ = nullptr;
    Network network_;
    std::vector<std::unique_ptr<Module>> modules_;
    std::vector<std::unique_ptr<Computer>> computers_;
    std::vector<cosim::Time> heard_until_;  ///< receivers are free from then on
    std::vector<Place> places_;
    std::vector<cosim::Message>* outbox_ = nullptr;
    cosim::Time granted_ = 0;
};

/// "08:00:17:2C:00:01". Throws InputError naming `place`.
Address parse_address(std::string_view place, std::string_view text);

/// From JSON: {"name", "seed", "range_m", "times": {...}, "modules": [{"name", "settings", ...}],
/// "computers": [...], "csv"}, all but names optional. Throws InputError.
std::unique_ptr<cosim::Node> make_air_node(std::string_view json);

}  // namespace puckloop::bluetooth
