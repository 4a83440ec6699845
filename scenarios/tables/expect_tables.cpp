#include "scenarios/tables/expect_tables.h"

#include "base/plain_text.h"
#include "scenarios/values/region_keys.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <type_traits>
#include <variant>

namespace puckloop::scenarios {

namespace {

constexpr std::array kSubjects{"log", "link", "robot", "no_reset", "board", "frame", "no_loss"};
constexpr std::size_t kMostBytes = 1000;
constexpr double kLongest = 720.0 * 3600.0;  // s, of a run

/// "56 0D": two hexadecimal digits a byte, blanks between them or not.
std::string bytes_of(Reader& table) {
    const std::string text = table.text("bytes");
    std::string digits, bytes;
    for (const char c : text) {
        if (c == ' ') continue;
        if (std::isxdigit(static_cast<unsigned char>(c)) == 0)
            table.fail("bytes", "not hexadecimal", "\"56 0D\"");
        digits += c;
    }
    if (digits.empty() || digits.size() % 2 != 0 || digits.size() > 2 * kMostBytes)
        table.fail("bytes", "not two digits a byte, or none, or more than 1000 bytes", "\"56 0D\"");
    for (std::size_t i = 0; i < digits.size(); i += 2)
        bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
    return bytes;
}

double instant(Reader& table, const char* key, double fallback) {
    const double seconds = table.quantity(key, Dimension::Time, fallback);
    if (!(seconds >= 0.0) || (std::isfinite(seconds) && seconds > kLongest))
        table.fail(key, fmt::format("{} is out of range", key), "0 s to 720 h");
    return seconds;
}

void read_log(Reader& table, Expectation& expected) {
    expected.text = table.text("text");
    if (expected.text.empty() || expected.text.find('\n') != std::string::npos)
        table.fail("text", "is looked for in lines", "a text of one line");
    expected.name = fmt::format("the log of {} {} '{}'", expected.subject, expected.seen ? "has" : "has no",
                                plain_text(expected.text, 64));
}

void read_line(Reader& table, Expectation& expected) {
    expected.from = table.text("from", "");
    expected.text = bytes_of(table);
    expected.name = fmt::format("{} {} {}", expected.subject, expected.seen ? "carries" : "never carries",
                                plain_text(table.text("bytes"), 64));
    if (!expected.from.empty()) expected.name += " from " + expected.from;
}

void read_place(Reader& table, Expectation& expected) {
    if (!table.has("centre")) table.fail_missing("centre", "of the region, [\"0 m\", \"0 m\"]");
    expected.region = read_region(table);
    expected.name = fmt::format("{} is {} the region around ({:g} m, {:g} m)", expected.subject,
                                expected.seen ? "in" : "never in", expected.region.x, expected.region.y);
}

void read_value(Reader& table, Expectation& expected) {
    constexpr double kFinest = 1e-6;
    expected.text = table.text("holds");
    expected.every = table.quantity("every", Dimension::Time, expected.every);
    if (!(expected.every >= kFinest && expected.every <= kLongest))
        table.fail("every", "every is out of range", "1 us to 720 h");
    expected.name = fmt::format("{} {} {}", expected.subject, expected.seen ? "has" : "never has",
                                plain_text(expected.text, 64));
}

void read_frame(Reader& table, Expectation& expected) {
    constexpr std::int64_t kMost = 1'000'000'000;
    expected.from = table.text("from", "");
    expected.text = table.text("text", "");
    expected.at_least = table.integer("at_least", 1, 1, kMost);
    if (!expected.seen && table.has("at_least"))
        table.fail("at_least", "at_least goes with no seen = false", "one of them");
    std::string fields;
    if (const TomlValue* has = table.table("has")) {
        for (const auto& [key, value] : Reader(table.file(), "has", *has).everything()) {
            const auto take = [&]<class T>(const T& one) {
                if constexpr (std::is_same_v<T, TomlArray> || std::is_same_v<T, TomlTable>) {
                    table.fail("has",
                               fmt::format("{} is no text, number, true or false", plain_text(key, 64)),
                               R"({ record = "actuators", left = 500 })");
                } else {
                    expected.has.emplace_back(key, one);
                    fields += fmt::format("{} {}={}", fields.empty() ? " with" : ",", key, one);
                }
            };
            std::visit(take, value.data);
        }
    }
    if (!expected.text.empty()) fields += " '" + expected.text + "'";
    const bool one = expected.at_least == 1;
    expected.name = fmt::format("{} {} frame{}{} come{}",
                                one ? expected.seen ? "one" : "no" : std::to_string(expected.at_least),
                                expected.subject, one ? "" : "s", plain_text(fields, 96), one ? "s" : "");
    if (!expected.from.empty()) expected.name += " from " + expected.from;
}

Expectation read_expectation(const Reader& top, const TomlValue& value, std::size_t number) {
    Reader table(top.file(), fmt::format("expect {}", number), value);
    Expectation expected;
    expected.place = place_of(value);
    const char* first = nullptr;
    for (std::size_t i = 0; i < kSubjects.size(); ++i) {
        if (!table.has(kSubjects[i])) continue;
        if (first != nullptr)
            table.fail(kSubjects[i], fmt::format("{} goes with no {}", kSubjects[i], first),
                       "two [[expect]] tables");
        first = kSubjects[i];
        expected.kind = static_cast<Expectation::Kind>(i);
        expected.subject = table.text(first);
    }
    if (first == nullptr)
        table.fail_missing("log", "or link, robot, board, frame, no_reset or no_loss: what something is "
                                  "expected of (docs/expect.md)");
    using Kind = Expectation::Kind;
    const bool never = expected.kind == Kind::NoReset || expected.kind == Kind::NoLoss;
    if (!never) expected.seen = table.flag("seen", true);
    if (!never && expected.kind != Kind::Log) {
        expected.after = instant(table, "after", expected.after);
        expected.by = instant(table, "by", expected.by);
        if (expected.by < expected.after) table.fail("by", "by is before after", "a later instant");
    }
    switch (expected.kind) {
    case Kind::Log:
        read_log(table, expected);
        break;
    case Kind::Line:
        read_line(table, expected);
        break;
    case Kind::Place:
        read_place(table, expected);
        break;
    case Kind::NoReset:
        expected.name = expected.subject + " starts once";
        break;
    case Kind::Value:
        read_value(table, expected);
        break;
    case Kind::Frame:
        read_frame(table, expected);
        break;
    case Kind::NoLoss:
        expected.name = expected.subject + " loses nothing";
        break;
    }
    if (expected.after > 0.0) expected.name += fmt::format(", after {:g} s", expected.after);
    if (std::isfinite(expected.by)) expected.name += fmt::format(", by {:g} s", expected.by);
    if (table.has("name")) {
        expected.stated = expected.name;
        expected.name = table.text("name");
    }
    table.finish();
    return expected;
}

}  // namespace

std::vector<Expectation> read_expectations(Reader& top) {
    std::vector<Expectation> all;
    for (const TomlValue* value : top.tables("expect"))
        all.push_back(read_expectation(top, *value, all.size() + 1));
    return all;
}

}  // namespace puckloop::scenarios
