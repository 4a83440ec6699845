// Faults of IRcom's words: what receivers read of each, whom a fault leaves alone, what it reports that it
// did.

#include "base/error.h"
#include "base/json.h"
#include "base/random.h"
#include "cosim/faults/fault_json.h"
#include "cosim/faults/kinds/kind_table.h"
#include "physics/ircom/ircom_node.h"
#include "protocols/infrared/ircom.h"
#include "tests/ircom/faults.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <numbers>

using namespace puckloop;
using namespace puckloop::ircom_test;
using namespace puckloop::physics;
using cosim::kMillisecond;
using protocols::IrcomReading;

namespace {

/// Three robots that all see one another.
World three() {
    World description = world();
    add_robot(description, "a", 0, 0, 0.5);
    add_robot(description, "b", 0.12, 0, std::numbers::pi);
    add_robot(description, "c", 0.06, 0.1, -1.5);
    return description;
}

struct Word {
    Time start = 0;
    PortIndex robot = 0;
    std::uint8_t value = 0;
};

struct Heard {
    std::array<std::vector<IrcomReading>, 3> by{};
    nlohmann::json report{};

    std::vector<int> words(std::size_t robot) const {
        std::vector<int> list;
        for (const IrcomReading& one : by[robot])
            if (one.ok()) list.push_back(one.word);
        return list;
    }
    int spoilt(std::size_t robot) const {
        return static_cast<int>(std::count_if(by[robot].begin(), by[robot].end(),
                                              [](const IrcomReading& one) { return !one.ok(); }));
    }
    int fired(std::size_t fault = 0) const { return report["faults"].at(fault)["fired"]; }
    std::string what() const { return report["faults"].at(0)["firings"].at(0).at(2); }
};

std::vector<Message> light_of(const std::vector<Word>& words) {
    std::vector<Message> messages;
    for (const Word& word : words)
        for (const auto& edge :
             protocols::ircom_edges(protocols::ircom_symbols(word.value), protocols::kIrcomEpuck))
            // The lines are switched one after the other.
            for (std::size_t line = 0; line < kIds.pulse.size(); ++line)
                messages.push_back({word.start + edge.time + static_cast<Time>(line) * 400'000, word.robot,
                                    Signal{kIds.pulse[line], edge.lit ? 1.0 : 0.0}});
    std::stable_sort(messages.begin(), messages.end(),
                     [](const Message& x, const Message& y) { return x.time < y.time; });
    return messages;
}

/// What robots read of words, cut as `step` states.
Heard listen(const std::vector<Word>& words, std::vector<cosim::FaultSpec> faults,
             Time step = 700 * kMillisecond) {
    IrcomNode node(three(), {"ircom", kIds, "", false, carried(std::move(faults))});
    const std::vector<Message> inbox = light_of(words);
    const Time end = (words.empty() ? 0 : words.back().start) + 700 * kMillisecond;
    Heard heard;
    std::array<std::array<double, 8>, 3> light{};
    std::array<protocols::IrcomReader, 3> readers{};
    std::size_t used = 0;
    for (Time now = 0; now < end; now += step) {
        std::vector<Message> due, out;
        for (; used < inbox.size() && inbox[used].time < now + step; ++used)
            due.push_back(inbox[used]);
        node.advance(now + step, due, out);
        for (const Message& message : out) {
            const auto& signal = std::get<Signal>(message.payload);
            const auto sensor =
                std::find(kIds.light.begin(), kIds.light.end(), signal.id) - kIds.light.begin();
            light[message.port][static_cast<std::size_t>(sensor)] = signal.value;
            const bool lit = *std::max_element(light[message.port].begin(), light[message.port].end()) > 1.0;
            if (const auto word = readers[message.port].edge(message.time, lit))
                heard.by[message.port].push_back(*word);
        }
    }
    for (std::size_t r = 0; r < 3; ++r)
        if (const auto word = readers[r].until(end + kMillisecond * 10)) heard.by[r].push_back(*word);
    heard.report = nlohmann::json::parse(node.finish());
    return heard;
}

/// From a: 0x10, 0x11, ... each 100 ms; from b the same from 0x20 on, 50 ms behind.
std::vector<Word> talk(int count) {
    std::vector<Word> words;
    for (int i = 0; i < count; ++i) {
        words.push_back({(10 + 100 * i) * kMillisecond, 0, static_cast<std::uint8_t>(0x10 + i)});
        words.push_back({(60 + 100 * i) * kMillisecond, 1, static_cast<std::uint8_t>(0x20 + i)});
    }
    return words;
}

cosim::FaultSpec from_a(const std::string& kind) {
    cosim::FaultSpec spec = ircom_fault(kind);
    spec.from = "a";
    return spec;
}

using Words = std::vector<int>;

}  // namespace

TEST_CASE("without faults robots hear all words, and the report has no faults") {
    const Heard heard = listen(talk(3), {});
    CHECK(heard.words(0) == Words{0x20, 0x21, 0x22});
    CHECK(heard.words(1) == Words{0x10, 0x11, 0x12});
    CHECK(heard.words(2) == Words{0x10, 0x20, 0x11, 0x21, 0x12, 0x22});
    CHECK_FALSE(heard.report.contains("faults"));
}

TEST_CASE("a word is lost for the one whom the fault names, the others hear it") {
    auto loss = from_a("loss").set("to", "b");
    loss.skip = 1;
    loss.count = 1;
    const Heard heard = listen(talk(3), {loss});
    CHECK(heard.fired() == 1);
    CHECK(heard.what() == "a word from a");
    CHECK(heard.report["faults"][0]["firings"][0][0] == 110 * kMillisecond);
    CHECK(heard.report["faults"][0]["firings"][0][1] == 1);
    CHECK(heard.words(1) == Words{0x10, 0x12});
    CHECK(heard.words(2) == Words{0x10, 0x20, 0x11, 0x21, 0x12, 0x22});
    CHECK(heard.words(0) == Words{0x20, 0x21, 0x22});
    // For all.
    CHECK(listen(talk(2), {ircom_fault("loss")}).words(2).empty());
}

TEST_CASE("half periods that are lost spoil a word, and no receiver takes it for another") {
    RandomStream random(5, "halves");
    for (int i = 0; i < 8; ++i) {
        auto corrupt = from_a("corrupt").set("halves", 1 + static_cast<double>(random.below(4)));
        corrupt.count = 1;
        const std::vector<Word> words{{kMillisecond, 0, static_cast<std::uint8_t>(random.below(256))},
                                      {90 * kMillisecond, 0, 0x5A}};
        const Heard heard = listen(words, {corrupt});
        CHECK(heard.fired() == 1);
        CHECK(heard.what().starts_with("half period "));
        CHECK(heard.words(1) == Words{0x5A});
        CHECK(heard.spoilt(1) >= 1);  // a long gap parts it
    }
}

TEST_CASE("flipped bits are found by the check, or not if their sum stays") {
    for (int bit = 0; bit < 10; ++bit) {
        auto flip = from_a("flip").set("bit", bit);
        flip.count = 1;
        const Heard heard = listen({{kMillisecond, 0, 0x35}}, {flip});
        CAPTURE(bit, heard.what());
        CHECK(heard.fired() == 1);
        CHECK(heard.words(1).empty());
        const auto& readings = heard.by[1];
        const auto whole = std::find_if(readings.begin(), readings.end(), [](const IrcomReading& one) {
            return one.fault == protocols::IrcomFault::Check;
        });
        REQUIRE(whole != readings.end());
        if (bit < 8) CHECK(whole->word == (0x35 ^ (0x80 >> bit)));
        // It comes when the word itself would be over.
        CHECK(whole->start == 41 * kMillisecond + kDelay);
    }
    // 0x35 = 00110101: the first two bits of 01 10 change places.
    auto swapped = from_a("flip").set("bit", 1).set("bits", 2);
    CHECK(listen({{kMillisecond, 0, 0x35}}, {swapped}).words(1) == Words{0x55});
}

TEST_CASE("words come late, twice, in another order") {
    auto late = from_a("delay").set("delay", 0.245);
    late.count = 1;
    const Heard behind = listen(talk(4), {late});
    CHECK(behind.words(1) == Words{0x11, 0x12, 0x10, 0x13});
    CHECK(behind.fired() == 1);
    const auto at = std::find_if(behind.by[1].begin(), behind.by[1].end(),
                                 [](const IrcomReading& one) { return one.ok() && one.word == 0x10; });
    CHECK(at->start - (10 + 245) * kMillisecond == kDelay);

    auto twice = from_a("duplicate").set("to", "c");
    twice.every = 2;
    const Heard doubled =
        listen({{kMillisecond, 0, 1}, {101 * kMillisecond, 0, 2}, {201 * kMillisecond, 0, 3}}, {twice});
    CHECK(doubled.words(2) == Words{1, 1, 2, 3, 3});
    CHECK(doubled.words(1) == Words{1, 2, 3});
    CHECK(doubled.fired() == 2);

    auto swap = from_a("swap");
    swap.count = 1;
    const Heard swapped =
        listen({{kMillisecond, 0, 1}, {101 * kMillisecond, 0, 2}, {201 * kMillisecond, 0, 3}}, {swap});
    CHECK(swapped.words(1) == Words{2, 1, 3});
    CHECK(swapped.fired() == 1);
    // Nothing behind it: it does not come at all.
    CHECK(listen({{kMillisecond, 0, 1}}, {swap}).words(1).empty());
}

TEST_CASE("edges that jitter little do no harm, more of it does") {
    auto jitter = from_a("jitter").set("jitter", 40e-6);
    CHECK(listen(talk(5), {jitter}).words(1) == Words{0x10, 0x11, 0x12, 0x13, 0x14});
    const Heard much = listen(talk(5), {from_a("jitter").set("jitter", 250e-6)});
    CHECK(much.words(1).empty());
    CHECK(much.fired() == 5);
    CHECK(much.words(0).size() == 5);
}

TEST_CASE("two senders clash where both are seen") {
    auto clash = from_a("clash").set("to", "b").set("value", 0xC3);
    clash.count = 2;
    const Heard heard = listen(talk(3), {clash});
    CHECK(heard.fired() == 2);
    CHECK(heard.what() == "word C3 beside a word from a");
    CHECK(heard.words(1) == Words{0x12});
    CHECK(heard.words(2) == Words{0x10, 0x20, 0x11, 0x21, 0x12, 0x22});
}

TEST_CASE("flashes are no words, and who reaches nobody cannot suffer") {
    std::vector<Word> none;
    // A proximity sensor's flashes: four lines, one after the other, again and again.
    IrcomNode node(three(), {"ircom", kIds, "", false, carried({ircom_fault("loss")})});
    std::vector<Message> inbox, out;
    for (int i = 0; i < 400; ++i)
        inbox.push_back(
            {kMillisecond + i * 650 * cosim::kMicrosecond / 2 + (i % 2) * 25 * cosim::kMicrosecond, 0,
             Signal{kIds.pulse[static_cast<std::size_t>(i / 2 % 4)], i % 2 == 0 ? 1.0 : 0.0}});
    inbox.resize(12);
    node.advance(700 * kMillisecond, inbox, out);
    CHECK(nlohmann::json::parse(node.finish())["faults"][0]["fired"] == 0);
    World alone = world();
    add_robot(alone, "a", 0, 0, 0.5);
    add_robot(alone, "b", 0.9, 0.9, 0.5);
    IrcomNode far(alone, {"ircom", kIds, "", false, carried({ircom_fault("loss")})});
    out.clear();
    far.advance(700 * kMillisecond, light_of({{kMillisecond, 0, 7}}), out);
    CHECK(nlohmann::json::parse(far.finish())["faults"][0]["fired"] == 0);
}

TEST_CASE("what faults do to words does not depend on how grants are cut") {
    std::vector<cosim::FaultSpec> faults;
    for (const cosim::KindInfo& kind : cosim::all_kinds()) {
        if (kind.place != cosim::PlaceKind::Ircom) continue;
        faults.push_back(ircom_fault(std::string(kind.name)));
        if (kind.name == "jitter") faults.back().set("jitter", 30e-6);
        if (kind.name == "delay") faults.back().set("delay", 0.05);
        faults.back().probability = 0.2;
        faults.back().name = kind.name;
    }
    CHECK(faults.size() == 8);
    const Heard whole = listen(talk(20), faults);
    for (std::size_t f = 0; f < faults.size(); ++f)
        CHECK(whole.fired(f) > 0);
    for (const Time step : {kMillisecond / 3, 7 * kMillisecond}) {
        const Heard cut = listen(talk(20), faults, step);
        CHECK(cut.report == whole.report);
        for (std::size_t r = 0; r < 3; ++r) {
            CHECK(cut.words(r) == whole.words(r));
            CHECK(cut.by[r].size() == whole.by[r].size());
        }
    }
}

TEST_CASE("a fault for a device that is not there is refused") {
    auto nobody = ircom_fault("loss");
    nobody.from = "z";
    CHECK_THROWS_WITH(IrcomNode(three(), {"ircom", kIds, "", false, carried({nobody})}),
                      Catch::Contains("there is no device 'z'"));
    CHECK_THROWS_AS(carried({ircom_fault("flip").set("bit", 8).set("bits", 3)}), InputError);
    CHECK_THROWS_AS(carried({ircom_fault("delay").set("delay", 0.001)}), InputError);
    CHECK_THROWS_AS(carried({ircom_fault("delay")}), InputError);
}
