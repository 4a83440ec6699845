// Whole runs with one byte of one record lost, doubled or flipped: the real program beside the emulated
// board, the fault from the scenario's own [[fault]]. The project's program and firmware, and for contrast
// ARGoS' unmodified program with the original firmware, which have no way back.

#include "base/random.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/framing/record_traffic.h"
#include "tests/framing/table.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

using namespace puckloop;
using namespace puckloop::tests;
using namespace puckloop::framing;

namespace {

constexpr std::size_t kRecord = 6;  // the record that is hit, counted from 0

struct Pair {
    std::string name;
    std::string scenario;
    Words words;  ///< of the run
    Forgets forgets{};
};

std::string fault_table(const Byte& byte, const std::string& kind) {
    return fmt::format("\n[[fault]]\nlink = \"robot0.uart\"\nfrom = \"robot0.{}\"\nkind = \"{}\"\ncount = 1\n"
                       "begin = \"{:.7f} s\"\nend = \"{:.7f} s\"\n",
                       byte.to_pic ? "linux" : "pic", kind, byte.start - 5e-6, byte.start + 5e-6);
}

class Contrast {
  public:
    explicit Contrast(Pair pair) : pair_(std::move(pair)) {
        run("plain", {});
        bytes_ = bytes_of(uart_rows(bench_, "plain"), kRecord);
        end_s_ = journey(bench_.csv("plain", "trajectory.csv")).last_s;
    }
    const std::vector<Byte>& bytes() const { return bytes_; }
    Outcome with(const Byte& byte, const std::string& kind) {
        run("fault", fault_table(byte, kind));
        REQUIRE(bench_.report("fault")["faults"][0]["fired"] == 1);
        Outcome out = judge(uart_rows(bench_, "fault"), pair_.forgets, byte.start, end_s_);
        out.drives = journey(bench_.csv("fault", "trajectory.csv"), end_s_ - 1).length > 0.002;
        return out;
    }

  private:
    void run(const std::string& name, const std::string& fault) {
        const auto file = bench_.file(name + ".toml", pair_.scenario + fault);
        Words words{"run", "--out", bench_.out(name), file, "--in-process"};
        words.insert(words.end(), pair_.words.begin(), pair_.words.end());
        const Ended ended = bench_.start(words)->wait(60);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
    }
    Pair pair_;
    Workbench bench_;
    std::vector<Byte> bytes_;
    double end_s_ = 0;
};

std::string scenario_text(const std::string& start) {
    std::string text = text_of(PUCKLOOP_SOURCE "/scenarios/own_binaries.toml");
    const auto put = [&](const std::string& old, const std::string& now) {
        const std::size_t at = text.find(old);
        REQUIRE(at != std::string::npos);
        text.replace(at, old.size(), now);
    };
    put("../firmware", PUCKLOOP_SOURCE "/firmware");
    put("start = \"42 s\"", "start = \"" + start + "\"");
    return text;
}

Pair own() {
    return {"puckloop-control, epuck.hex", scenario_text("1 s"), {"--duration", "4.2"}};
}

/// ARGoS' unmodified program, on the original firmware or on ours.
std::optional<Pair> argos(bool on_original) {
    const auto image = outside("PUCKLOOP_IMAGES", "epuck_firmware.hex");
    const auto program = outside("PUCKLOOP_ARGOS", "argos_epuck");
    const auto experiment = outside("PUCKLOOP_ARGOS", "avoid.argos");
    if (!image || !program || !experiment) {
        WARN("PUCKLOOP_IMAGES has no epuck_firmware.hex, or PUCKLOOP_ARGOS no argos_epuck and avoid.argos: "
             "skipped");
        return std::nullopt;
    }
    Pair pair{"argos_epuck, epuck.hex", scenario_text("1 s"), {"--duration", "4.2"}, {true, false}};
    if (on_original)
        pair = {"argos_epuck, epuck_firmware.hex",
                scenario_text("42 s"),
                {"--duration", "45.2", "--firmware", "robot0.pic=" + image->string()},
                {false, false}};
    const Words linux_words{"--linux", program->string(), "-c", experiment->string(), "-i", "avoid"};
    pair.words.insert(pair.words.end(), linux_words.begin(), linux_words.end());
    return pair;
}

struct Tally {
    int cases = 0, hang = 0, drives_on = 0, shifted = 0, goes_on = 0;
    double gap = 0;
    void count(const Outcome& out) {
        ++cases;
        const bool hang_here = !out.linux_goes_on || !out.pic_goes_on;
        hang += hang_here;
        drives_on += hang_here && out.drives;
        shifted += !hang_here && out.shifted;
        goes_on += !hang_here && !out.shifted;
        gap = std::max(gap, out.gap);
    }
};

void add(Table& table, const std::string& name, bool to_pic, const char* kind, const Tally& t) {
    table.add(fmt::format("{},{},{},{},{},{},{},{},{:.3f}", name, to_pic ? "actuator" : "sensor", kind,
                          t.cases, t.hang, t.drives_on, t.shifted, t.goes_on, t.gap));
}
constexpr const char* kColumns = "pair,record,fault,cases,hangs,of them driving on,shifted for good,goes on "
                                 "in step,longest silence of the PIC s";

void check_own(const Outcome& out, const Byte& byte, const std::string& kind) {
    INFO(kind << ' ' << (byte.to_pic ? "to" : "from") << " the PIC, byte " << byte.place << " gap "
              << out.gap);
    CHECK(out.linux_goes_on);
    CHECK(out.pic_goes_on);
    CHECK_FALSE(out.shifted);
    CHECK(out.gap < 0.4);  // a control period and three to recover
}

}  // namespace

TEST_CASE("records: whole runs with one byte lost, doubled or flipped go on, own program and firmware") {
    Contrast contrast(own());
    RandomStream random(51, "record contrast");
    for (const char* kind : {"drop", "duplicate", "flip"}) {
        for (const bool to_pic : {true, false}) {
            const Byte& byte = contrast.bytes()[to_pic ? random.below(kActuatorBytes)
                                                       : kActuatorBytes + random.below(kSensorBytes)];
            check_own(contrast.with(byte, kind), byte, kind);
        }
    }
}

TEST_CASE("records: ARGoS' program and the original firmware hang or stay shifted for ever", "[argos]") {
    const auto pair = argos(true);
    if (!pair) return;
    Contrast contrast(*pair);
    RandomStream random(52, "record contrast");
    const auto draw = [&](bool to_pic) -> const Byte& {
        return contrast
            .bytes()[to_pic ? random.below(kActuatorBytes) : kActuatorBytes + random.below(kSensorBytes)];
    };
    for (const bool to_pic : {true, false}) {
        const Outcome lost = contrast.with(draw(to_pic), "drop");
        CHECK_FALSE(lost.linux_goes_on);
        CHECK_FALSE(lost.pic_goes_on);
        CHECK(lost.gap > 2);
        CHECK(lost.drives);
    }
    for (const bool to_pic : {true, false}) {
        const Outcome doubled = contrast.with(draw(to_pic), "duplicate");
        CHECK(doubled.linux_goes_on);
        CHECK(doubled.shifted);
    }
}

TEST_CASE("records: every byte of whole runs, ours and ARGoS' program on either firmware", "[.slow]") {
    Table table("records_contrast.csv", kColumns);
    for (const std::optional<Pair>& pair : {std::optional<Pair>(own()), argos(false), argos(true)}) {
        if (!pair) continue;
        const bool is_own = pair->name == own().name;
        Contrast contrast(*pair);
        for (const char* kind : {"drop", "duplicate", "flip"}) {
            for (const bool to_pic : {true, false}) {
                Tally tally;
                for (const Byte& byte : contrast.bytes()) {
                    if (byte.to_pic != to_pic) continue;
                    const Outcome out = contrast.with(byte, kind);
                    tally.count(out);
                    if (is_own) check_own(out, byte, kind);
                }
                add(table, pair->name, to_pic, kind, tally);
            }
        }
    }
}
