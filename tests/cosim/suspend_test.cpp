// Nodes that wait for something outside of simulated time: others go on meanwhile, and no trace shows it.

#include "base/random.h"
#include "toy_run.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <utility>

using namespace puckloop;
using namespace puckloop::cosim;
using toy::Recorder;
using toy::Run;

namespace {

/// So many nodes stand in the middle of a grant, and how many did at most.
struct Suspended {
    int now = 0, most = 0;
};

/// A toy that is asked in vain some times before it has done what it was granted.
class Slow : public Node, public Suspendable {
  public:
    Slow(std::unique_ptr<Node> node, std::uint64_t seed, Suspended& suspended)
        : node_(std::move(node)), vain_(seed, "vain"), suspended_(suspended) {}

    std::string_view name() const override { return node_->name(); }
    std::span<const Port> ports() const override { return node_->ports(); }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        node_->advance(until, inbox, outbox);
    }
    Time earliest_output(PortIndex port) const override { return node_->earliest_output(port); }
    Time lookahead(PortIndex port) const override { return node_->lookahead(port); }
    std::optional<Time> begun(PortIndex port) const override { return node_->begun(port); }
    std::optional<Stop> stop() const override { return node_->stop(); }
    std::string finish() override { return node_->finish(); }
    Rewindable* rewindable() override { return node_->rewindable(); }

    Suspendable* suspendable() override { return this; }
    bool begin(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        until_ = until;
        inbox_.assign(inbox.begin(), inbox.end());
        outbox_ = &outbox;
        left_ = vain_.below(6);
        suspended_.most = std::max(suspended_.most, ++suspended_.now);
        return resume(false);
    }
    bool resume(bool wait) override {
        if (left_ > 0 && !wait) {
            --left_;
            return false;
        }
        --suspended_.now;
        node_->advance(until_, inbox_, *outbox_);
        return true;
    }

  private:
    std::unique_ptr<Node> node_;
    RandomStream vain_;
    Suspended& suspended_;
    Time until_ = 0;
    std::vector<Message> inbox_;
    std::vector<Message>* outbox_ = nullptr;
    std::uint64_t left_ = 0;
};

/// The run with every second node slow; nodes of bit `ahead` run ahead, slow ones as far as they can.
Outcome run_slowly(Run run, unsigned ahead, unsigned threads, Suspended& suspended, Recorder& recorder) {
    for (std::size_t n = 0; n < run.nodes.size(); ++n)
        if ((ahead >> n & 1) != 0) {
            run.nodes[n].json += n % 2 == 1 ? " ahead=1" : " ahead=1 bounded=1";
            run.nodes[n].any_thread = n % 2 == 1;
        }
    run.options.threads = threads;
    std::uint64_t made = 0;
    Conductor conductor(run.nodes, run.links, {}, run.options, [&](const std::string& line) {
        std::unique_ptr<Node> node = toy::make(line);
        if (++made % 2 == 0) return node;
        return std::unique_ptr<Node>(std::make_unique<Slow>(std::move(node), made, suspended));
    });
    conductor.add_sink(recorder);
    return conductor.run();
}

}  // namespace

TEST_CASE("no trace shows that nodes waited for something outside of simulated time") {
    int most = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        const Run run = toy::random_chatter(seed, 3 + static_cast<int>(seed % 5));
        Recorder plain;
        const Outcome expected = run(&plain);
        REQUIRE(expected.reason == EndReason::Duration);
        RandomStream random(seed, "ahead");
        for (const unsigned threads : {1u, 2u, 4u}) {
            Suspended suspended;
            Recorder recorder;
            const Outcome outcome =
                run_slowly(run, static_cast<unsigned>(random.below(256)), threads, suspended, recorder);
            INFO("seed " << seed << ", " << threads << " threads: " << outcome.text);
            CHECK(outcome.reason == EndReason::Duration);
            CHECK(outcome.trace_sha256 == expected.trace_sha256);
            REQUIRE((recorder.records == plain.records));
            CHECK(suspended.now == 0);
            most = std::max(most, suspended.most);
        }
    }
    CHECK(most >= 3);  // at a time: nobody waits for one of them alone
}

TEST_CASE("a node that fails after it was waited for is named") {
    Run run = toy::random_chatter(5, 4);
    run.nodes.push_back({"bad", "thrower at_us=7000"});
    for (const unsigned threads : {1u, 2u}) {
        Suspended suspended;
        Recorder recorder;
        const Outcome outcome = run_slowly(run, ~0u, threads, suspended, recorder);
        CHECK(outcome.reason == EndReason::Failed);
        CHECK(outcome.node == "bad");
        CHECK(outcome.text.find("node bad stopped at simulated time") != std::string::npos);
    }
}
