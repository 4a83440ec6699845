// Measures what the conductor costs in a swarm: nodes with the links, EOTs and lookaheads of robots with
// range-and-bearing boards, but nothing to do. No test, run by hand: cosim_swarm_cost [simulated seconds]

#include "cosim/conductor.h"

#include <fmt/format.h>

#include <cstdlib>
#include <map>

using namespace puckloop::cosim;

namespace {

constexpr Time kEdge = 98 * kMicrosecond;   // a chip on the air
constexpr Time kDelay = 20 * kMicrosecond;  // of the demodulators
constexpr Time kSclClock = 10 * kMicrosecond;

/// How one port of a toy behaves.
struct ToyPort {
    Port port;
    bool busy = false;    ///< may send at any time; otherwise only in answer
    Time every = kNever;  ///< sends a signal so often
    Time lookahead = kNever;
    Time ahead = 0;  ///< it knows so early what it will send
};

class Toy final : public Node {
  public:
    Toy(std::string name, std::vector<ToyPort> toys) : name_(std::move(name)), toys_(std::move(toys)) {
        for (const ToyPort& toy : toys_) {
            ports_.push_back(toy.port);
            next_.push_back(toy.every);
        }
    }
    std::string_view name() const override { return name_; }
    std::span<const Port> ports() const override { return ports_; }
    void advance(Time until, std::span<const Message>, std::vector<Message>& outbox) override {
        for (std::size_t p = 0; p < next_.size(); ++p)
            for (; next_[p] < until + toys_[p].ahead; next_[p] += toys_[p].every)
                outbox.push_back({next_[p], static_cast<PortIndex>(p), Signal{0, 1.0}});
        granted_ = until;
    }
    Time earliest_output(PortIndex port) const override {
        return toys_[port].busy ? granted_ : std::max(granted_, next_[port]);
    }
    Time lookahead(PortIndex port) const override { return toys_[port].lookahead; }

  private:
    std::string name_;
    std::vector<ToyPort> toys_;
    std::vector<Port> ports_;
    std::vector<Time> next_;
    Time granted_ = 0;
};

ToyPort signals(const std::string& name, bool busy, Time every, Time lookahead) {
    return {{name, PortKind::Signals}, busy, every, lookahead, 0};
}
ToyPort i2c(const std::string& name, bool busy, Time lookahead) {
    return {{name, PortKind::I2c}, busy, kNever, lookahead, 0};
}

/// Name of a node -> its ports.
std::map<std::string, std::vector<ToyPort>> nodes_of(int robots) {
    std::map<std::string, std::vector<ToyPort>> nodes;
    std::vector<ToyPort> world, ir;
    for (int r = 0; r < robots; ++r) {
        const std::string robot = fmt::format("robot{}", r);
        nodes[robot + ".pic"] = {{{"uart2", PortKind::Uart}, true, kNever, 0, 0},
                                 i2c("i2c", true, 0),
                                 signals("world", true, kMillisecond, 0)};
        nodes[robot + ".linux"] = {{{"uart", PortKind::Uart}, false, kNever, 0, 0}, i2c("i2c", false, 0)};
        nodes[robot + ".i2c"] = {i2c("pic", false, kSclClock), i2c("linux", false, kSclClock),
                                 i2c("rab", false, 0), signals("world", false, kNever, kSclClock)};
        nodes[robot + ".rab"] = {i2c("i2c", false, 7 * kSclClock), signals("ir", true, kEdge, 0)};
        world.push_back(signals(robot + ".board", false, kMillisecond, kMillisecond));
        world.push_back(signals(robot + ".ground", false, kMillisecond, kMillisecond));
        world[world.size() - 2].ahead = world.back().ahead = kMillisecond;
        ir.push_back(signals(robot + ".ir", false, kEdge, kDelay));
        ir.back().ahead = kDelay;
    }
    world.push_back(signals("ir", false, kMillisecond, kMillisecond));
    world.back().ahead = kMillisecond;
    ir.push_back(signals("world", false, kNever, kNever));
    nodes["world"] = world;
    nodes["ir"] = ir;
    return nodes;
}

std::vector<LinkSpec> links_of(int robots) {
    std::vector<LinkSpec> links;
    for (int r = 0; r < robots; ++r) {
        const std::string robot = fmt::format("robot{}", r);
        const std::string bus = robot + ".i2c";
        links.push_back({robot + ".world", {robot + ".pic", "world"}, {"world", robot + ".board"}});
        links.push_back({robot + ".ground", {bus, "world"}, {"world", robot + ".ground"}});
        links.push_back({robot + ".i2c.pic", {robot + ".pic", "i2c"}, {bus, "pic"}});
        links.push_back({robot + ".i2c.linux", {robot + ".linux", "i2c"}, {bus, "linux"}});
        links.push_back({robot + ".i2c.rab", {robot + ".rab", "i2c"}, {bus, "rab"}});
        links.push_back({robot + ".uart", {robot + ".linux", "uart"}, {robot + ".pic", "uart2"}, 115200.0});
        links.push_back({robot + ".ir", {robot + ".rab", "ir"}, {"ir", robot + ".ir"}});
    }
    links.push_back({"ir.world", {"ir", "world"}, {"world", "ir"}});
    return links;
}

}  // namespace

int main(int argc, char** argv) {
    const double seconds = argc > 1 ? std::atof(argv[1]) : 1.0;
    for (const int robots : {1, 2, 8}) {
        auto nodes = nodes_of(robots);
        std::vector<NodeSpec> specs;
        for (const auto& [name, ports] : nodes)
            specs.push_back({name, name, {}});
        RunOptions options;
        options.duration = from_seconds(seconds);
        options.in_process = true;
        Conductor conductor(specs, links_of(robots), {}, options, [&](const std::string& name) {
            return std::make_unique<Toy>(name, nodes.at(name));
        });
        const Outcome outcome = conductor.run();
        if (!outcome.success) fmt::print("{}\n", outcome.text);
        fmt::print("{} robots: {} grants, {:.3f} s wall, {:.2f} us a grant, {:.1f} x real time, {}\n", robots,
                   outcome.grants, outcome.wall_s, 1e6 * outcome.wall_s / static_cast<double>(outcome.grants),
                   to_seconds(outcome.simulated) / outcome.wall_s, outcome.trace_sha256.substr(0, 12));
        for (const auto& node : outcome.nodes)
            if (node.name == "ir" || node.name == "world" || node.name.starts_with("robot0"))
                fmt::print("    {} {}\n", node.name, node.grants);
    }
}
