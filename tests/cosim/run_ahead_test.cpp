// Nodes that run ahead on what is foreseen: how one node is executed, and that no trace shows it.

#include "cosim/schedule/run_ahead.h"

#include "base/error.h"
#include "base/random.h"
#include "toy_run.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::cosim;
using toy::Recorder;
using toy::Run;

namespace {

const std::vector<PortEcho> kNoEchoes;

Message said(Time time, std::uint16_t id) {
    return {time, 0, Signal{id, 1.0}};
}

/// Sends its count of messages every 100; notes what it executed.
class Counter final : public Node, public Rewindable {
  public:
    std::string_view name() const override { return "counter"; }
    std::span<const Port> ports() const override { return ports_; }
    Time earliest_output(PortIndex) const override { return next_; }
    Time lookahead(PortIndex) const override { return received_ == 0 ? 40 : 7; }
    std::optional<Stop> stop() const override {
        return now_ > stop_at ? std::optional<Stop>(Stop{stop_at, true, "enough", 1}) : std::nullopt;
    }
    Rewindable* rewindable() override { return this; }

    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        for (const Message& message : inbox) {
            REQUIRE(message.time >= now_);
            REQUIRE(message.time < until);
            act_before(message.time, outbox);
            received_ += std::get<Signal>(message.payload).id;
        }
        act_before(until, outbox);
        executed += until - now_;
        now_ = until;
    }
    void mark() override {
        saved_ = {now_, next_, received_};
        ++marks;
    }
    void rewind() override {
        std::tie(now_, next_, received_) = saved_;
        ++rewinds;
    }
    void settle() override {}
    std::string finish() override { return std::to_string(now_); }

    Time executed = 0;
    int marks = 0, rewinds = 0;
    Time throws_at = kNever;
    Time stop_at = kNever - 1;

  private:
    void act_before(Time until, std::vector<Message>& outbox) {
        if (throws_at < until && received_ == 0) throw RunError("on purpose");
        for (; next_ < until; next_ += 100)
            outbox.push_back(said(next_, static_cast<std::uint16_t>(received_)));
    }

    std::vector<Port> ports_{{"signals", PortKind::Signals}};
    Time now_ = 0, next_ = 100;
    int received_ = 0;
    std::tuple<Time, Time, int> saved_;
};

struct Fixture {
    Counter* counter = new Counter;
    RunAhead node{std::unique_ptr<Node>(counter)};
    std::vector<Message> outbox;

    Advanced advance(Time until, Time ahead, const std::vector<Message>& inbox = {}) {
        return node.advance({until, until, ahead}, inbox, kNoEchoes, outbox);
    }
    NodeState state() const {
        NodeState state;
        node.read_state(state);
        return state;
    }
};

}  // namespace

TEST_CASE("what was foreseen rightly is not executed again") {
    Fixture f;
    Advanced done = f.advance(150, 450, {said(320, 2)});
    CHECK(done.reached == 150);
    CHECK(done.ahead == 450);
    CHECK(done.sure == 1);
    CHECK(f.outbox == std::vector<Message>{said(100, 0), said(200, 0), said(300, 0), said(400, 2)});
    CHECK(f.state().ports[0].earliest_output == 500);
    CHECK(f.state().ports[0].lookahead == 7);  // the shortest within what was run ahead

    done = f.advance(330, 450, {said(320, 2)});  // less than was foreseen is granted
    CHECK(done.ahead == 450);
    CHECK(done.sure == 0);
    CHECK(f.outbox == std::vector<Message>{said(200, 0), said(300, 0), said(400, 2)});
    done = f.advance(450, 450);
    CHECK(done.sure == 3);
    CHECK(f.counter->executed == 450);
    CHECK(f.counter->rewinds == 0);
    CHECK(f.node.finish() == "450");
}

TEST_CASE("what came in unforeseen, or did not come in, is executed again from the mark") {
    Fixture f;
    f.advance(150, 450, {said(320, 2)});
    Advanced done = f.advance(250, 450);  // it will not come in after all
    CHECK(done.sure == 1);
    CHECK(f.outbox == std::vector<Message>{said(200, 0), said(300, 0), said(400, 0)});
    CHECK(f.counter->rewinds == 1);
    done = f.advance(300, 500, {said(260, 1), said(270, 4), said(499, 1)});
    CHECK(done.ahead == 500);
    CHECK(done.sure == 0);  // stamped 300: not before it
    CHECK(f.outbox == std::vector<Message>{said(300, 5), said(400, 5)});
    CHECK(f.counter->rewinds == 2);
    // Once more from the same mark, which stays before what was granted meanwhile.
    f.advance(350, 500, {said(499, 1)});
    CHECK(f.counter->rewinds == 2);
    done = f.advance(360, 500, {said(355, 1), said(499, 1)});
    CHECK(f.outbox == std::vector<Message>{said(300, 5), said(400, 6)});
    CHECK(f.counter->rewinds == 3);
}

TEST_CASE("without anything foreseen a node that ran ahead goes back to what is sure") {
    Fixture f;
    f.advance(150, 450);
    const Advanced done = f.advance(150, 150);
    CHECK(done.ahead == 150);
    CHECK(done.sure == 0);
    CHECK(f.outbox.empty());
    CHECK(f.state().ports[0].earliest_output == 200);
    f.advance(220, 900);
    CHECK(f.node.finish() == "220");
}

TEST_CASE("an exception beyond what is sure counts only once that is sure") {
    Fixture f;
    f.counter->throws_at = 400;
    Advanced done = f.advance(150, 800);
    CHECK(done.ahead == 150);
    CHECK(f.outbox == std::vector<Message>{said(100, 0)});
    done = f.advance(250, 300);  // not tried again
    CHECK(done.ahead == 250);
    // With this message it does not come to that.
    done = f.advance(900, 900, {said(380, 3)});
    CHECK(done.ahead == 900);
    CHECK(f.outbox.back() == said(800, 3));

    Fixture again;
    again.counter->throws_at = 400;
    CHECK_THROWS_WITH(again.advance(500, 800), "on purpose");
}

namespace {

/// What comes in stops what it would send 50 later, and what comes in next starts it again.
class Holder final : public Node, public Rewindable {
  public:
    std::string_view name() const override { return "holder"; }
    std::span<const Port> ports() const override { return ports_; }
    Time earliest_output(PortIndex) const override { return due_; }
    Time lookahead(PortIndex) const override { return 50; }
    Rewindable* rewindable() override { return this; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        for (const Message& message : inbox) {
            send_before(message.time, outbox);
            due_ = due_ == kNever ? message.time + 50 : kNever;
        }
        send_before(until, outbox);
    }
    void mark() override { saved_ = due_; }
    void rewind() override { due_ = saved_; }
    void settle() override {}

  private:
    void send_before(Time until, std::vector<Message>& outbox) {
        if (due_ < until) outbox.push_back(said(std::exchange(due_, kNever), 1));
    }
    std::vector<Port> ports_{{"signals", PortKind::Signals}};
    Time due_ = kNever, saved_ = kNever;
};

}  // namespace

TEST_CASE("what a foreseen message takes away may come, should the message not") {
    RunAhead node(std::make_unique<Holder>());
    std::vector<Message> outbox;
    NodeState state;
    // Due at 110; stopped at 100; due again at 250.
    node.advance({90, 90, 220}, std::vector<Message>{said(60, 0), said(100, 0), said(200, 0)}, kNoEchoes,
                 outbox);
    node.read_state(state);
    CHECK(outbox.empty());
    CHECK(state.ports[0].earliest_output == 250);
    CHECK(state.ports[0].lookahead == 10);  // without what comes in at 100 it is sent at 110
    node.advance({95, 95, 220}, std::vector<Message>{said(200, 0)}, kNoEchoes, outbox);
    CHECK(outbox == std::vector<Message>{said(110, 1)});
    node.read_state(state);
    CHECK(state.ports[0].lookahead == 50);
}

namespace {

/// A counter that cannot go back from beyond `gate`, nor from behind a message of number 9.
class Gated final : public Node, public BoundedRewindable {
  public:
    std::string_view name() const override { return "gated"; }
    std::span<const Port> ports() const override { return ports_; }
    Time earliest_output(PortIndex) const override { return kNever; }
    Time lookahead(PortIndex) const override { return 0; }
    Rewindable* rewindable() override { return this; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        CHECK((!marked_ || until <= horizon(inbox)));
        for (const Message& message : inbox)
            outbox.push_back(said(message.time, std::get<Signal>(message.payload).id));
        now_ = until;
    }
    void mark() override {
        marked_ = true;
        saved_ = now_;
    }
    void rewind() override { now_ = saved_; }
    void settle() override { marked_ = false; }
    Time horizon(std::span<const Message> next) const override {
        Time first = now_ <= gate ? gate : kNever;
        for (const Message& message : next)
            if (std::get<Signal>(message.payload).id == 9) first = std::min(first, message.time);
        return std::max(first, now_);
    }
    Time gate = kNever;

  private:
    std::vector<Port> ports_{{"signals", PortKind::Signals}};
    Time now_ = 0, saved_ = 0;
    bool marked_ = false;
};

}  // namespace

TEST_CASE("a node runs ahead no further than it can come back from") {
    auto* gated = new Gated;
    RunAhead node{std::unique_ptr<Node>(gated)};
    std::vector<Message> outbox;
    NodeState state;
    const auto horizon = [&] {
        node.read_state(state);
        CHECK(state.bounded);
        return state.horizon;
    };
    gated->gate = 400;
    Advanced done = node.advance({100, 100, 900}, std::vector<Message>{said(200, 1)}, kNoEchoes, outbox);
    CHECK(done.ahead == 400);
    CHECK(done.sure == 0);
    CHECK(outbox == std::vector<Message>{said(200, 1)});
    CHECK(horizon() == 400);
    // Asked once more: nothing to do. Granted for sure it goes beyond, and ahead from there, up to the 9,
    // even where another message comes at the same time.
    done = node.advance({100, 100, 900}, std::vector<Message>{said(200, 1)}, kNoEchoes, outbox);
    CHECK(done.ahead == 400);
    const std::vector<Message> inbox{said(200, 1), said(450, 2), said(700, 3), said(700, 9)};
    done = node.advance({500, 500, 900}, inbox, kNoEchoes, outbox);
    CHECK(done.reached == 500);
    CHECK(done.ahead == 700);
    CHECK(done.sure == 2);
    CHECK(horizon() == 700);
    // The 9 does not come after all.
    done = node.advance({600, 600, 900}, std::vector<Message>{said(700, 3)}, kNoEchoes, outbox);
    CHECK(done.ahead == 900);
    CHECK(horizon() == kNever);
    done = node.advance({900, 900, 900}, std::vector<Message>{said(700, 3)}, kNoEchoes, outbox);
    CHECK(done.sure == 1);
    CHECK(outbox == std::vector<Message>{said(700, 3)});
}

TEST_CASE("a request to stop is known when its time is final") {
    Fixture f;
    f.counter->stop_at = 200;
    f.advance(150, 450);
    CHECK(!f.state().stop);
    f.advance(250, 450);
    REQUIRE(f.state().stop);
    CHECK(f.state().stop->time == 200);
}

TEST_CASE("what comes of any sequence of grants is what one grant makes of it") {
    RandomStream random(11, "grants");
    for (int round = 0; round < 300; ++round) {
        std::vector<Message> truth;
        for (Time time = 1; time < 2000; time += 1 + static_cast<Time>(random.below(200)))
            truth.push_back(said(time, static_cast<std::uint16_t>(random.below(3))));
        Counter plain;
        std::vector<Message> expected, sure;
        plain.advance(2000, truth, expected);

        Fixture f;
        Time reached = 0;
        while (reached < 2000) {
            const Time until = std::min<Time>(2000, reached + static_cast<Time>(random.below(150)));
            const Time ahead = until + static_cast<Time>(random.below(300));
            std::vector<Message> inbox;
            for (const Message& message : truth)
                if (message.time >= reached && message.time < ahead &&
                    (message.time < until || random.below(4) != 0))
                    inbox.push_back(message);
            const Advanced done = f.advance(until, ahead, inbox);
            sure.insert(sure.end(), f.outbox.begin(),
                        f.outbox.begin() + static_cast<std::ptrdiff_t>(done.sure));
            REQUIRE(done.reached == until);
            reached = until;
        }
        f.advance(2000, 2000);
        sure.insert(sure.end(), f.outbox.begin(), f.outbox.end());
        REQUIRE(sure == expected);
    }
}

namespace {

/// The same network, its nodes with bit n of `subset` able to go back, those of `bounded` from some places.
Run with_ahead(Run run, unsigned subset, unsigned bounded = 0) {
    for (std::size_t n = 0; n < run.nodes.size(); ++n) {
        if ((subset >> n & 1) != 0) run.nodes[n].json += " ahead=1";
        if ((bounded >> n & 1) != 0) run.nodes[n].json += " bounded=1";
    }
    return run;
}

void check_same(const Outcome& a, const Outcome& b) {
    CHECK(a.trace_sha256 == b.trace_sha256);
    CHECK(a.text == b.text);
    REQUIRE(a.nodes.size() == b.nodes.size());
    for (std::size_t n = 0; n < a.nodes.size(); ++n)
        CHECK(a.nodes[n].json == b.nodes[n].json);
}

}  // namespace

TEST_CASE("no trace shows that nodes ran ahead") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const int count = 2 + static_cast<int>(seed % 6);
        const Run run = toy::random_chatter(seed, count);
        Recorder plain;
        const Outcome expected = run(&plain);
        INFO(expected.text);
        REQUIRE(expected.reason == EndReason::Duration);
        RandomStream random(seed, "subset");
        for (int variant = 0; variant < 6; ++variant) {
            const unsigned subset = variant == 0 ? ~0u : static_cast<unsigned>(random.below(1u << count));
            const unsigned bounded = variant < 4 ? 0u : static_cast<unsigned>(random.below(1u << count));
            Run ahead = with_ahead(run, subset | bounded, bounded);
            if (variant == 2 || variant == 3 || variant == 5) ahead.options.chop_seed = seed;
            if (variant == 3) ahead.options.threads = 2;
            if (variant == 3)
                for (NodeSpec& node : ahead.nodes)
                    node.any_thread = true;
            Recorder recorder;
            const Outcome outcome = ahead(&recorder);
            INFO("seed " << seed << " subset " << subset << ": " << outcome.text);
            check_same(expected, outcome);
            REQUIRE((recorder.records == plain.records));
        }
    }
}

TEST_CASE("nodes run ahead in processes of their own, too") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        Run run = with_ahead(toy::random_chatter(seed, 4), seed == 1 ? ~0u : 5u, seed == 3 ? 4u : 0u);
        run.options.duration = 10 * kMillisecond;
        const Outcome here = run();
        REQUIRE(here.reason == EndReason::Duration);
        run.options.in_process = false;
        check_same(here, run());
    }
}

static void check_ahead(const Run& run, std::uint64_t seed) {
    Recorder plain;
    const Outcome expected = run(&plain);
    INFO(expected.text);
    REQUIRE(expected.reason == EndReason::Duration);
    for (const unsigned subset : {0u, ~0u}) {
        Run in_windows = with_ahead(run, subset);
        in_windows.options.windows = true;
        in_windows.options.threads = 1 + static_cast<unsigned>(seed % 2);
        Recorder recorder;
        const Outcome outcome = in_windows(&recorder);
        INFO("in windows, seed " << seed << ": " << outcome.text);
        check_same(expected, outcome);
        REQUIRE((recorder.records == plain.records));
    }
    for (const unsigned subset : {~0u, 1u, 6u, 21u}) {
        Recorder recorder;
        const Outcome outcome = with_ahead(run, subset)(&recorder);
        INFO("seed " << seed << " subset " << subset << ": " << outcome.text);
        check_same(expected, outcome);
        REQUIRE((recorder.records == plain.records));
    }
}

/// Faults of these kinds on each UART link.
static void harm_lines(Run& run, std::initializer_list<const char*> kinds) {
    for (const LinkSpec& link : run.links)
        if (link.nominal_baud > 0.0)
            for (const char* kind : kinds) {
                FaultSpec fault;
                fault.link = link.name;
                fault.kind = kind;
                fault.probability = 0.3;
                if (fault.kind == "delay") fault.set("delay", 3e-4);
                run.faults.push_back(fault);
            }
}

TEST_CASE("faults fire the same when the sender or the receiver runs ahead") {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Run run = toy::random_chatter(seed, 5);
        harm_lines(run, {"drop", "delay", "duplicate"});
        check_ahead(run, seed);
    }
}

TEST_CASE("what comes in behind a surprise that is taken back again is not lost") {
    // Nodes of a bus go in turns, which may end before the place where the surprised one stands. Here a
    // message was lost when its inbox ended with the turn.
    Run run = toy::random_chatter(56, 5);
    run.options.duration = 10 * kMillisecond;
    for (NodeSpec& node : run.nodes)
        node.json += " bus=1 gap_us=800";
    harm_lines(run, {"drop", "delay"});
    check_ahead(run, 56);
}

TEST_CASE("nodes that hear themselves hear the same when they run ahead, in grants of any length") {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Run run = toy::random_chatter(seed, 4);
        bool through = false;
        for (const LinkSpec& link : run.links) {
            if (link.nominal_baud == 0.0) continue;
            FaultSpec fault;
            fault.link = link.name;
            fault.kind = "loopback";
            fault.begin = static_cast<Time>(seed) * kMillisecond;
            if (seed % 2) fault.from = link.b.node;
            if (std::exchange(through, !through)) fault.set("through", 1);
            run.faults.push_back(fault);
        }
        REQUIRE(!run.faults.empty());
        check_ahead(run, seed);
        const std::string plain = run().trace_sha256;
        for (const std::uint64_t chop : {1, 2, 3}) {
            run.options.chop_seed = chop;
            CHECK(run().trace_sha256 == plain);
        }
        if (seed > 2) continue;
        run.options.in_process = false;
        CHECK(run().trace_sha256 == plain);
    }
}

TEST_CASE("a run of nodes that run ahead ends when one wants it to, exactly") {
    for (const unsigned subset : {0u, 1u, 7u}) {
        Run run{
            {{"a", "chatter seed=4 uarts=1"}, {"b", "chatter seed=5 uarts=2"}, {"c", "stopper at_us=7003"}},
            {toy::uart("ab", {"a", "uart0"}, {"b", "uart0"}),
             toy::uart("bc", {"b", "uart1"}, {"c", "uart0"})}};
        run = with_ahead(run, subset);
        run.options.in_process = true;
        const Outcome outcome = run();
        CHECK(outcome.reason == EndReason::NodeStopped);
        CHECK(outcome.stop_time == 7003 * kMicrosecond);
        CHECK(outcome.simulated == 7003 * kMicrosecond + run.options.stop_latency);
    }
}

TEST_CASE("a node that sends before its earliest output time having run ahead is named") {
    Run run{{{"a", "liar at_us=2000 ahead=1"}, {"b", "chatter seed=5 ahead=1"}},
            {toy::uart("ab", {"a", "uart0"}, {"b", "uart0"})}};
    run.options.in_process = true;
    run.options.duration = 10 * kMillisecond;
    const Outcome outcome = run();
    CHECK(outcome.reason == EndReason::Failed);
    CHECK(outcome.node == "a");
    CHECK_THAT(outcome.text, Catch::Contains("sent before its earliest output time on port uart0"));
}

TEST_CASE("nodes that seldom speak go in long stretches, however close they are coupled") {
    // Four in a ring with 2 us from one to the next; each speaks some ten times in 20 ms.
    Run run;
    for (int n = 0; n < 4; ++n) {
        run.nodes.push_back(
            {fmt::format("n{}", n),
             fmt::format("chatter seed={} uarts=0 signals=2 think_us=0 fly_us=2 gap_us=2000", n + 1)});
        run.links.push_back({fmt::format("l{}", n),
                             {fmt::format("n{}", n), "signals0"},
                             {fmt::format("n{}", (n + 1) % 4), "signals1"}});
    }
    run.options.in_process = true;
    run.options.duration = 200 * kMillisecond;
    const Outcome plain = run();
    const Outcome ahead = with_ahead(run, ~0u)();
    check_same(plain, ahead);
    CHECK(ahead.links[0].from_a.messages > 10);
    INFO(plain.grants << " and " << ahead.grants);
    CHECK(ahead.grants < 20'000);
}
