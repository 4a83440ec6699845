// Whole runs with one byte of one record lost, doubled or flipped: the real program beside the emulated
// board, the fault from the scenario's own [[fault]]. The project's program and firmware, and for contrast
// ARGoS' unmodified program with the original firmware, which have no way back.

#include "base/random.h"
#include "tests/end_to_end/workbench.h"
#include "tests/framing/table.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::tests;
using framing::Table;

namespace {

constexpr std::size_t kHello = 5, kActuatorBytes = 12, kSensorBytes = 72;
constexpr std::size_t kRecord = 6;  // the record that is hit, counted from 0
constexpr double kSilence = 0.020;  // s

struct Pair {
    std::string name;
    std::string scenario;
    Words words;  ///< of the run
    /// A part of a record is forgotten after 20 ms of silence.
    bool pic_forgets = true, linux_forgets = true;
};

/// One byte's start bit on its way.
struct Byte {
    bool to_pic = true;
    std::size_t place = 0;  ///< in its record
    double start = 0;
};

struct Outcome {
    bool linux_goes_on = false;  ///< it still sends records at the end
    bool pic_goes_on = false;
    bool shifted = false;  ///< to the end, one side takes parts of two records for one
    bool drives = false;   ///< the robot moves in the last second
    double gap = 0;        ///< s, the longest without a byte from the PIC
};

std::vector<Row> uart_rows(const Workbench& bench, const std::string& name) {
    std::vector<Row> rows = bench.csv(name, "trace.csv");
    std::erase_if(rows, [](const Row& row) { return row.at("kind") != "uart"; });
    return rows;
}

bool from_linux(const Row& row) {
    return row.at("from") == "robot0.linux";
}

/// Starts of the bytes of both records number kRecord in a run without a fault, the actuator record's first.
std::vector<Byte> bytes_of(const std::vector<Row>& rows) {
    std::vector<Byte> bytes;
    std::size_t sent = 0, heard = 0;
    for (const Row& row : rows) {
        const bool to_pic = from_linux(row);
        const std::size_t ordinal = to_pic ? sent++ : heard++;
        if (to_pic && ordinal < kHello) continue;
        const std::size_t size = to_pic ? kActuatorBytes : kSensorBytes;
        const std::size_t at = to_pic ? ordinal - kHello : ordinal;
        if (at / size == kRecord) bytes.push_back({to_pic, at % size, std::stod(row.at("start_s"))});
    }
    REQUIRE(bytes.size() == kActuatorBytes + kSensorBytes);
    std::stable_sort(bytes.begin(), bytes.end(),
                     [](const Byte& a, const Byte& b) { return a.to_pic > b.to_pic; });
    return bytes;
}

std::string fault_table(const Byte& byte, const std::string& kind) {
    return fmt::format("\n[[fault]]\nlink = \"robot0.uart\"\nfrom = \"robot0.{}\"\nkind = \"{}\"\ncount = 1\n"
                       "begin = \"{:.7f} s\"\nend = \"{:.7f} s\"\n",
                       byte.to_pic ? "linux" : "pic", kind, byte.start - 5e-6, byte.start + 5e-6);
}

/// Bytes on one way, as its receiver counts them into records.
struct Way {
    std::size_t bytes = 0;
    double last = 0;
    void arrive(double start, bool forgets) {
        if (forgets && start - last > kSilence) bytes = 0;
        last = start;
        ++bytes;
    }
};

/// Looks at what went over the line after `fault_s`.
Outcome judge(const std::vector<Row>& rows, const Pair& pair, double fault_s, double end_s) {
    Outcome out;
    Way to_pic, from_pic;
    std::size_t hello = 0;
    bool answering = false, sending = false;  // a record of that side has begun
    double last_pic = fault_s;
    for (const Row& row : rows) {
        const double start = std::stod(row.at("start_s"));
        const bool late = start > end_s - 0.5;
        if (from_linux(row)) {
            out.linux_goes_on = out.linux_goes_on || late;
            // The program begins a record: it has taken whole sensor records only, or has some bytes left
            // over.
            if (late && !sending && from_pic.bytes % kSensorBytes != 0) out.shifted = true;
            sending = true;
            answering = false;
            if (row.at("fault") != "drop" && ++hello > kHello) to_pic.arrive(start, pair.pic_forgets);
            continue;
        }
        out.pic_goes_on = out.pic_goes_on || late;
        if (late && !answering && to_pic.bytes % kActuatorBytes != 0) out.shifted = true;
        answering = true;
        sending = false;
        if (row.at("fault") != "drop") from_pic.arrive(start, pair.linux_forgets);
        if (start > fault_s) {
            out.gap = std::max(out.gap, start - last_pic);
            last_pic = start;
        }
    }
    out.gap = std::max(out.gap, end_s - last_pic);
    return out;
}

class Contrast {
  public:
    explicit Contrast(Pair pair) : pair_(std::move(pair)) {
        run("plain", {});
        bytes_ = bytes_of(uart_rows(bench_, "plain"));
        end_s_ = journey(bench_.csv("plain", "trajectory.csv")).last_s;
    }
    const std::vector<Byte>& bytes() const { return bytes_; }
    Outcome with(const Byte& byte, const std::string& kind) {
        run("fault", fault_table(byte, kind));
        REQUIRE(bench_.report("fault")["faults"][0]["fired"] == 1);
        Outcome out = judge(uart_rows(bench_, "fault"), pair_, byte.start, end_s_);
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
    Pair pair{"argos_epuck, epuck.hex", scenario_text("1 s"), {"--duration", "4.2"}, true, false};
    if (on_original)
        pair = {"argos_epuck, epuck_firmware.hex",
                scenario_text("42 s"),
                {"--duration", "45.2", "--firmware", "robot0.pic=" + image->string()},
                false,
                false};
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
