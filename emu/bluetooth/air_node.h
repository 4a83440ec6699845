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

/// A robot's module.
struct RobotModule {
    ModuleOptions module{};
    int pose = -1;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(part(&RobotModule::module),
                     field("pose", &RobotModule::pose,
                           "signal of the world at which its place begins (x, y; m); -1: it has none"));
    }
};
static_assert(lists_all_fields<RobotModule>);

struct AirSpec {
    static constexpr std::string_view kKind = "bluetooth";

    std::string name = "bluetooth";
    std::uint64_t seed = 1;
    Times times{};
    double range = 10.0;
    std::vector<RobotModule> modules{};
    std::vector<ComputerOptions> computers{};
    std::string csv{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("name", &AirSpec::name, "of the node"),
                     field("seed", &AirSpec::seed, "of the run"), part(&AirSpec::times),
                     field("range_m", &AirSpec::range, "within which devices hear each other").in("m"),
                     field("modules", &AirSpec::modules, "of the robots; ports by their names").required(),
                     field("computers", &AirSpec::computers, "linked with them"),
                     field("csv", &AirSpec::csv, "log of the air; empty: none"));
    }
};
static_assert(lists_all_fields<AirSpec>);

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
    void receive_frame(std::size_t port, const cosim::UartFrame& frame, cosim::Time now);
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

}  // namespace puckloop::bluetooth
