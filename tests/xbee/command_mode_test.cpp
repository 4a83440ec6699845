// "+++", guard times, lines of commands; sleep by the pin and by the module's own clock.

#include "tests/xbee/host.h"

#include "base/random.h"

using namespace puckloop;
using namespace puckloop::xbee;
using namespace puckloop::xbee::test;

namespace {

constexpr std::uint64_t kOther = 0x0013A200408A3107;
constexpr Time kGuard = 1000 * kMs;  // GT

ModuleOptions transparent() {
    ModuleOptions options = escaped();
    options.parameters = {{"AP", 0}, {"BD", 3}, {"ID", 0x01B5}, {"DH", 0x0013A200}, {"DL", 0x408A3107}};
    return options;
}

class Terminal : public Host {
  public:
    Terminal() : Host(transparent()) { boot(); }

    void type(const std::string& text) { say_bytes(XBeeBytes(text.begin(), text.end())); }
    /// What it sends within `time`.
    std::string answer(Time time = 60 * kMs) {
        bytes.clear();
        run(time);
        return {bytes.begin(), bytes.end()};
    }
    std::string line(const std::string& text) {
        type(text + "\r");
        return answer();
    }
    std::string enter() {
        run(kGuard);
        type("+++");
        return answer(kGuard + 50 * kMs);
    }
    /// A packet's data, one behind the other.
    std::string on_air() const {
        std::string text;
        for (const auto& [at, frame] : sent)
            text.append(frame.data.begin(), frame.data.end());
        return text;
    }
};

}  // namespace

TEST_CASE("+++ between two silences leads to command mode, and nothing of it goes on air") {
    Terminal host;
    CHECK(host.enter() == "OK\r");
    CHECK(host.line("AT") == "OK\r");
    CHECK(host.line("ATCH") == "C\r");
    CHECK(host.line("atid") == "1B5\r");
    CHECK(host.line("ATNI") == "TAM07\r");
    CHECK(host.line("ATSH") == "13A200\r");
    CHECK(host.line("AT NI Pluto 9") == "OK\r");
    CHECK(host.line("ATNI") == "TAM07\r");  // in force only once applied
    CHECK(host.line("ATCH 0f,NT,ac,CH") == "OK\r82\rOK\rF\r");
    CHECK(host.line("ATNI") == "Pluto 9\r");
    CHECK(host.line("ATCH 30") == "ERROR\r");
    CHECK(host.line("ATCH zz") == "ERROR\r");
    CHECK(host.line("ATQQ") == "ERROR\r");
    CHECK(host.line("hello") == "ERROR\r");
    CHECK(host.line("ATC") == "ERROR\r");
    CHECK(host.line("") == "");
    CHECK(host.sent.empty());
    CHECK(host.line("ATCN") == "OK\r");
    host.type("data");
    host.run(50 * kMs);
    CHECK(host.on_air() == "data");
    const auto report = host.report();
    CHECK(report["at"]["command_modes"] == 1);
    CHECK(report["at"]["unknown"]["QQ"] == 1);
    CHECK(report["at"]["bad_values"] == 2);
}

TEST_CASE("what is no +++ with its silences is data") {
    Terminal host;
    const auto says = [&](const std::string& before, const std::string& text, Time pause,
                          const std::string& after) {
        host.run(2 * kGuard);
        host.sent.clear();
        host.type(before);
        host.run(before.empty() ? 0 : 20 * kMs);
        host.type(text);
        host.run(pause);
        host.type(after);
        host.answer(2 * kGuard);
        for (const auto& [at, frame] : host.sent)
            host.fate({frame.sequence, 0, 0, 0});
        return host.on_air();
    };
    CHECK(says("x", "+++", 2 * kGuard, "") == "x+++");  // no silence before
    CHECK(says("", "+++", 500 * kMs, "y") == "+++y");   // none after
    CHECK(says("", "++++", 2 * kGuard, "") == "++++");  // one too many
    CHECK(says("", "++", 2 * kGuard, "+") == "+++");    // too slow
    CHECK(says("", "++x+", 2 * kGuard, "") == "++x+");
    CHECK(host.report()["at"]["command_modes"] == 0);
    // Another character, another silence.
    CHECK(host.enter() == "OK\r");
    CHECK(host.line("ATCC 23,GT 64,CN") == "OK\rOK\rOK\r");
    host.run(100 * kMs);
    host.type("###");
    CHECK(host.answer(150 * kMs) == "OK\r");
}

TEST_CASE("command mode ends by itself after CT, and the air waits for that") {
    Terminal host;
    REQUIRE(host.enter() == "OK\r");
    CHECK(host.line("ATCT 5,AC") == "OK\rOK\r");
    CHECK(host.line("ATCH E") == "OK\r");
    MeshFrame frame;
    frame.origin = kOther;
    frame.target = 0x0013A200408C04A4;
    frame.data = {'h', 'i'};
    host.hear(frame);
    CHECK(host.answer(300 * kMs).empty());
    CHECK(host.answer(300 * kMs) == "hi");
    CHECK(host.node.module().settings()[kCH] == 0xE);
    CHECK(host.line("ATCH").empty());
}

TEST_CASE("ND lists modules line by line, DN sets the destination and ends command mode") {
    Terminal host;
    REQUIRE(host.enter() == "OK\r");
    CHECK(host.line("ATNT 20,AC") == "OK\rOK\r");
    host.type("ATND\r");
    host.run(50 * kMs);
    REQUIRE(host.sent.size() == 1);
    MeshFrame shown;
    shown.kind = MeshKind::Discovered;
    shown.origin = kOther;
    shown.target = 0x0013A200408C04A4;
    const std::uint16_t sequence = host.sent[0].second.sequence;
    shown.data = {static_cast<std::uint8_t>(sequence >> 8), static_cast<std::uint8_t>(sequence), 'C', 'O'};
    host.hear(shown);
    CHECK(host.answer(500 * kMs) == "FFFE\r13A200\r408A3107\rCO\rFFFE\r01\r00\rC105\r101E\r\r");
    CHECK(host.answer(3000 * kMs) == "\r");
    host.type("ATDN CO\r");
    host.run(50 * kMs);
    REQUIRE(host.sent.size() == 2);
    const std::uint16_t second = host.sent[1].second.sequence;
    shown.origin = 0x0013A20011223344;
    shown.data[0] = static_cast<std::uint8_t>(second >> 8);
    shown.data[1] = static_cast<std::uint8_t>(second);
    host.hear(shown);
    CHECK(host.answer(100 * kMs) == "OK\r");
    host.sent.clear();
    host.type("x");
    host.run(50 * kMs);
    REQUIRE(host.sent.size() == 1);
    CHECK(host.sent[0].second.target == 0x0013A20011223344);
    // Nobody of that name.
    REQUIRE(host.enter() == "OK\r");
    host.type("ATDN NOBODY\r");
    CHECK(host.answer(3400 * kMs) == "ERROR\r");
}

TEST_CASE("a command line may be anything: it is answered or left, and the next one is understood") {
    Terminal host;
    RandomStream random(3, "lines");
    for (int i = 0; i < 20; ++i) {
        REQUIRE(host.enter() == "OK\r");
        std::string text = random.below(2) == 0 ? "AT" : "";
        for (std::uint64_t left = random.below(400); left > 0; --left)
            text += static_cast<char>(random.below(20) == 0 ? '\r' : 1 + random.below(254));
        // These would lead elsewhere, or take long.
        for (const char* word : {"CN", "FR", "ND", "DN", "WR", "AP", "BD"})
            for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos;)
                text[at] = '?';
        host.type(text + "\r");
        host.answer(1500 * kMs);
        CHECK(host.line("ATVR") == "8073\r");
        host.line("ATRE,CN");
        host.pin(1, 1);
        host.run(10 * kMs);
        host.pin(1, 0);
        host.run(100 * kMs);
    }
}

TEST_CASE("SM 1: asleep while SLEEP_RQ is high, off the air and deaf at its line") {
    ModuleOptions options = escaped();
    options.parameters.emplace_back("SM", 1);
    Host host(options);
    host.boot();
    CHECK(host.ask("SM").value == XBeeBytes{1});
    host.pin(5, 1);
    host.run(20 * kMs);
    REQUIRE(host.words.size() == 1);
    CHECK_FALSE(host.words[0].second.on);
    CHECK(host.cts == std::vector<double>{1.0});
    const std::size_t before = host.said.size();
    host.say(XBeeAt{.id = 1, .command = {'V', 'R'}, .value = {}});
    host.run(200 * kMs);
    CHECK(host.said.size() == before);
    host.pin(5, 0);
    host.run(20 * kMs);
    CHECK(host.words.back().second.on);
    CHECK(host.cts == std::vector<double>{1.0, 0.0});
    CHECK(host.ask("VR").status == kAtOk);
    const auto report = host.report();
    CHECK(report["sleeps"] == 1);
    CHECK(report["uart"]["while_asleep"] == 8);
    CHECK(report["at"]["without_effect"] == 0);
    // Without SM the pin does nothing.
    Host awake;
    awake.boot();
    awake.pin(5, 1);
    awake.run(50 * kMs);
    CHECK(awake.ask("VR").status == kAtOk);
    // A sleep of the whole network is kept and counted, no more.
    CHECK(awake.ask("SM", {8}).status == kAtOk);
    CHECK(awake.report()["at"]["without_effect"] == 1);
    CHECK(awake.ask("VR").status == kAtOk);
}

TEST_CASE("SM 4: asleep for SP after ST without a byte or packet, a packet under way is finished first") {
    ModuleOptions options = escaped();
    options.parameters.insert(options.parameters.end(), {{"SM", 4}, {"SP", 100}, {"ST", 300}});
    Host host(options);
    host.run(100 * kMs);
    host.words.clear();
    host.run(6000 * kMs);
    // On and off in turn: 0.3 s awake, 1 s asleep.
    REQUIRE(host.words.size() >= 8);
    for (std::size_t i = 0; i + 1 < host.words.size(); ++i) {
        CHECK(host.words[i].second.on == (i % 2 == 1));
        CHECK(host.words[i + 1].first - host.words[i].first == (i % 2 == 0 ? 1000 * kMs : 300 * kMs));
    }
    while (!host.words.back().second.on)
        host.run(10 * kMs);
    host.words.clear();
    host.say(XBeeTx{.id = 1, .to = kOther, .data = {1}});
    host.run(1500 * kMs);
    CHECK(host.words.empty());
    REQUIRE(host.sent.size() == 1);
    host.fate({host.sent[0].second.sequence, 0, 0, 0});
    host.run(500 * kMs);
    REQUIRE(host.words.size() == 1);
    CHECK_FALSE(host.words[0].second.on);
    CHECK(host.all<XBeeTxStatus>().size() == 1);
}
