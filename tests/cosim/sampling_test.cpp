// Nodes that wait for what comes in only when they come to need it (cosim/core/sampled_inputs.h): the trace
// is the one of nodes that wait for everything.

#include "cosim/core/sampled_inputs.h"

#include "base/random.h"
#include "toy_run.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

namespace puckloop::cosim {
namespace {

using toy::Recorder;

constexpr Time kTick = kMillisecond;
constexpr Time kFlight = 20 * kMicrosecond;

/// From event to event; the ports are signals.
class Stepping : public Node {
  public:
    Stepping(std::string name, std::vector<std::string> ports) : name_(std::move(name)) {
        for (std::string& port : ports)
            ports_.push_back({std::move(port), PortKind::Signals});
    }
    std::string_view name() const override { return name_; }
    std::span<const Port> ports() const override { return ports_; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        run(until, inbox, outbox);
    }

  protected:
    virtual Time next_event() const = 0;
    virtual void handle(Time now, std::vector<Message>& outbox) = 0;
    virtual void receive(const Message&, std::vector<Message>&) {}
    /// Where handle() and receive() do not let the node go on.
    virtual Time end() const { return kNever; }
    /// Messages come before events of the same instant.
    Time run(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
        for (auto message = inbox.begin();;) {
            const Time event = next_event();
            const Time next = message == inbox.end() ? event : std::min(event, message->time);
            if (next >= std::min(until, end())) break;
            if (message != inbox.end() && message->time == next)
                receive(*message++, outbox);
            else
                handle(next, outbox);
        }
        return reached_ = std::max(reached_, std::min(until, end()));
    }
    static Message signal(Time time, PortIndex port, double value) { return {time, port, Signal{0, value}}; }

    Time reached_ = 0;

  private:
    std::string name_;
    std::vector<Port> ports_;
};

/// Sends by every port at each tick, and has that settled before.
class Ticker : public Stepping, public Rewindable {
  public:
    explicit Ticker(const std::string& name) : Stepping(name, {"other", "lamp"}) {}
    Time earliest_output(PortIndex) const override { return next_; }
    Time lookahead(PortIndex) const override { return kNever; }
    Rewindable* rewindable() override { return this; }
    void mark() override { mark_ = {next_, reached_}; }
    void rewind() override { std::tie(next_, reached_) = mark_; }
    void settle() override {}

  private:
    Time next_event() const override { return next_; }
    void handle(Time now, std::vector<Message>& outbox) override {
        for (const PortIndex port : {PortIndex{0}, PortIndex{1}})
            outbox.push_back(signal(now, port, static_cast<double>(now)));
        next_ += kTick;
    }

    Time next_ = kTick;
    std::pair<Time, Time> mark_{};
};

/// Changes its light at drawn times, and at ticks.
class Lamp : public Stepping {
  public:
    explicit Lamp(std::uint64_t seed) : Stepping("lamp", {"light", "tick"}), random_(seed, "lamp") {}
    Time earliest_output(PortIndex port) const override { return port == 0 ? reached_ : kNever; }
    Time lookahead(PortIndex port) const override { return port == 0 ? 0 : kNever; }

  private:
    Time next_event() const override { return next_; }
    void handle(Time now, std::vector<Message>& outbox) override {
        outbox.push_back(signal(now, 0, ++level_));
        next_ = now + 1 + static_cast<Time>(random_.below(60 * kMicrosecond));
    }
    void receive(const Message& message, std::vector<Message>& outbox) override {
        outbox.push_back(signal(message.time, 0, ++level_));
    }

    RandomStream random_;
    Time next_ = 1;
    double level_ = 0;
};

/// Looks at the light now and then, and reports what it sees.
class Looker : public Stepping, public SampledInputs, public Rewindable {
  public:
    explicit Looker(std::uint64_t seed) : Stepping("looker", {"light", "report"}), own_{{seed, "looker"}} {}
    Time earliest_output(PortIndex port) const override { return port == 1 ? own_.next : kNever; }
    Time lookahead(PortIndex port) const override { return port == 1 ? 0 : kNever; }
    Rewindable* rewindable() override { return this; }
    void mark() override { mark_ = {own_, reached_}; }
    void rewind() override { std::tie(own_, reached_) = *mark_; }
    void settle() override {}

    bool sampled(PortIndex port) const override { return port == 0; }
    Time advance_sampling(const SampledReach& reach, std::span<const Message> inbox,
                          std::vector<Message>& outbox) override {
        if (reach.until <= reached_ && !inbox.empty() && inbox.back().time >= kTick + kFlight) ++late;
        known_ = reach.known;
        const Time came = run(reach.until, inbox, outbox);
        known_ = kNever;
        return came;
    }
    /// Messages from after the first tick that came when it had passed them.
    static inline int late = 0;

  private:
    struct Own {
        RandomStream random;
        Time next = 700 * kMicrosecond;
        double level = 0;
    };

    Time next_event() const override { return own_.next; }
    Time end() const override { return own_.next >= known_ ? own_.next : kNever; }
    void handle(Time now, std::vector<Message>& outbox) override {
        outbox.push_back(signal(now, 1, own_.level));
        own_.next = now + 600 * kMicrosecond + static_cast<Time>(own_.random.below(200 * kMicrosecond));
    }
    void receive(const Message& message, std::vector<Message>&) override {
        own_.level = std::get<Signal>(message.payload).value;
    }

    Own own_;
    Time known_ = kNever;
    std::optional<std::pair<Own, Time>> mark_;
};

/// Two of them talk in turns by "line": the first asks at drawn times, the second answers after a drawn time.
/// Meanwhile each sends by "out" at drawn times, and at once what it has been asked or answered.
class Talker : public Stepping, public SampledInputs {
  public:
    Talker(const std::string& name, std::uint64_t seed, bool asks)
        : Stepping(name, {"line", "out"}), random_(seed, name), asks_(asks), mine_(asks) {}
    Time earliest_output(PortIndex port) const override { return port == 0 && !mine_ ? kNever : reached_; }
    Time lookahead(PortIndex port) const override { return port == 0 && !mine_ ? kLeast : 0; }

    bool sampled(PortIndex) const override { return false; }
    std::optional<PortIndex> turn_port() const override { return PortIndex{0}; }
    bool has_turn() const override { return mine_; }
    Time advance_sampling(const SampledReach& reach, std::span<const Message> inbox,
                          std::vector<Message>& outbox) override {
        answered_ = mine_ ? reach.answered : kNever;
        const Time came = run(reach.until, inbox, outbox);
        answered_ = end_ = kNever;
        beyond += came > reach.answered ? 1 : 0;
        return came;
    }
    /// How often one went further than its partner would have let it.
    static inline int beyond = 0;

  private:
    static constexpr Time kLeast = 10 * kMicrosecond;

    Time next_event() const override { return std::min(says_, next_); }
    Time end() const override { return end_; }
    void handle(Time now, std::vector<Message>& outbox) override {
        if (says_ != now) {
            outbox.push_back(signal(now, 1, 0));
            next_ = now + 1 + static_cast<Time>(random_.below(100 * kMicrosecond));
            return;
        }
        outbox.push_back(signal(now, 0, static_cast<double>(now)));
        says_ = kNever;
        mine_ = false;
        if (answered_ != kNever) end_ = std::max(answered_, now + 1);
    }
    void receive(const Message& message, std::vector<Message>& outbox) override {
        outbox.push_back(signal(message.time, 1, std::get<Signal>(message.payload).value));
        mine_ = true;
        const Time rest = asks_ ? 300 * kMicrosecond : 80 * kMicrosecond;
        says_ = message.time + kLeast + static_cast<Time>(random_.below(static_cast<std::uint64_t>(rest)));
    }

    RandomStream random_;
    bool asks_;
    bool mine_;
    Time says_ = asks_ ? 50 * kMicrosecond : kNever;
    Time next_ = 1;
    Time answered_ = kNever, end_ = kNever;
};

std::unique_ptr<Node> make(const std::string& line) {
    const std::string kind = line.substr(0, line.find(' '));
    const std::uint64_t seed = std::stoull(line.substr(line.find(' ') + 1));
    if (kind == "a" || kind == "b") return std::make_unique<Ticker>(kind);
    if (kind == "lamp") return std::make_unique<Lamp>(seed);
    if (kind == "looker") return std::make_unique<Looker>(seed);
    if (kind == "sink") return toy::make("idle uarts=0 signals=2");
    return std::make_unique<Talker>(kind, seed, kind == "asker");
}

struct Setting {
    std::vector<std::string> kinds;
    std::vector<LinkSpec> links;

    Outcome run(std::uint64_t seed, RunOptions options, Recorder& recorder) const {
        std::vector<NodeSpec> nodes;
        for (const std::string& kind : kinds)
            nodes.push_back({kind, kind + " " + std::to_string(seed)});
        options.duration = 30 * kMillisecond;
        options.in_process = true;
        options.node_command = toy::kNodeCommand;
        Conductor conductor(nodes, links, {}, options, make);
        conductor.add_sink(recorder);
        return conductor.run();
    }
    /// In windows, however grants are cut, and without.
    void check(std::uint64_t seed) const {
        Recorder plain;
        const Outcome before = run(seed, {}, plain);
        INFO("seed " << seed << ": " << before.text);
        REQUIRE(before.reason == EndReason::Duration);
        for (const std::uint64_t chop : {std::uint64_t{0}, seed}) {
            RunOptions options;
            options.windows = true;
            if (chop != 0) options.chop_seed = chop;
            Recorder windows;
            const Outcome outcome = run(seed, options, windows);
            INFO("chop " << chop << ": " << outcome.text);
            REQUIRE(outcome.reason == EndReason::Duration);
            REQUIRE(windows.records == plain.records);
            REQUIRE(outcome.trace_sha256 == before.trace_sha256);
        }
    }
};

}  // namespace

TEST_CASE("a node that is ahead of its light when a run leaves windows gets it all the same") {
    // The tickers' ticks at one instant are settled, but no plain grant leads beyond them.
    Setting setting{{"a", "b", "lamp", "looker", "sink"},
                    {{"ticks", {"a", "other"}, {"b", "other"}},
                     {"switch", {"a", "lamp"}, {"lamp", "tick"}},
                     {"light", {"lamp", "light"}, {"looker", "light"}},
                     {"report", {"looker", "report"}, {"sink", "signals0"}}}};
    setting.links[2].latency = kFlight;
    Looker::late = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
        setting.check(seed);
    CHECK(Looker::late > 0);
}

TEST_CASE("nodes that talk in turns do not wait for each other in their own turn") {
    const Setting setting{{"asker", "answerer", "sink"},
                          {{"line", {"asker", "line"}, {"answerer", "line"}},
                           {"out1", {"asker", "out"}, {"sink", "signals0"}},
                           {"out2", {"answerer", "out"}, {"sink", "signals1"}}}};
    Talker::beyond = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
        setting.check(seed);
    CHECK(Talker::beyond > 0);
}

}  // namespace puckloop::cosim
