#include "traces/fault_marks.h"

#include "base/error.h"
#include "traces/i2c_transfers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace puckloop::tools {

namespace {

constexpr std::string_view kColumns = "fault,kind,place,firing,time_s,from,index,what";
constexpr std::size_t kColumnCount = 8;

/// "2.000000000001", as faults.csv has it; nothing for anything else.
std::optional<cosim::Time> time_of(std::string_view text) {
    constexpr std::size_t kDecimals = 12;
    const std::size_t dot = text.find('.');
    if (dot == std::string_view::npos || text.size() != dot + 1 + kDecimals) return std::nullopt;
    std::int64_t whole = 0, part = 0;
    const auto read = [](std::string_view digits, std::int64_t& value) {
        const char* const end = digits.data() + digits.size();
        return !digits.empty() && std::from_chars(digits.data(), end, value).ptr == end && value >= 0;
    };
    constexpr std::int64_t kLatest = 9'000'000;
    if (!read(text.substr(0, dot), whole) || !read(text.substr(dot + 1), part) || whole > kLatest)
        return std::nullopt;
    return whole * cosim::kSecond + part;
}

/// The word behind `name`, " bit " say; empty: there is none.
std::string_view word_behind(std::string_view text, std::string_view name) {
    const std::size_t at = text.rfind(name);
    if (at == std::string_view::npos) return {};
    const std::string_view rest = text.substr(at + name.size());
    return rest.substr(0, rest.find(' '));
}

/// A name may hold commas, nothing else does: columns are counted from the end.
std::vector<std::string_view> columns_of(std::string_view line) {
    std::vector<std::string_view> columns;
    while (columns.size() + 1 < kColumnCount) {
        const std::size_t comma = line.rfind(',');
        if (comma == std::string_view::npos) return {};
        columns.push_back(line.substr(comma + 1));
        line = line.substr(0, comma);
    }
    columns.push_back(line);
    std::reverse(columns.begin(), columns.end());
    return columns;
}

/// Nothing for a fault whose frames have a mark of their own.
std::optional<FaultMark> mark_of(std::string_view line, const std::string& file, std::size_t number) {
    const auto columns = columns_of(line);
    const auto time = columns.empty() ? std::nullopt : time_of(columns[4]);
    if (!time)
        throw InputError(file, fmt::format("line {}", number), "is no firing of a fault",
                         std::string(kColumns));
    if (!columns[5].empty()) return std::nullopt;
    FaultMark mark{*time, std::string(columns[2]), std::string(columns[1]), std::string(columns[7])};
    int bit = 0;
    const std::string_view digits = word_behind(mark.what, " bit ");
    if (!digits.empty() &&
        std::from_chars(digits.data(), digits.data() + digits.size(), bit).ec == std::errc())
        mark.bit = bit;
    mark.low_from = time_of(word_behind(mark.what, " low from "));
    mark.until = time_of(word_behind(mark.what, " until "));
    return mark;
}

bool in_time(const TraceSelection& selection, const FaultMark& mark) {
    return mark.time >= cosim::from_seconds(selection.from_s) &&
           mark.time < cosim::from_seconds(selection.until_s);
}

/// Marks of bytes go with their bytes; the others are chosen by place.
bool is_wanted(const TraceSelection& selection, const FaultMark& mark) {
    const auto among = [](const std::vector<std::string>& list, const auto& has) {
        return list.empty() || std::any_of(list.begin(), list.end(), has);
    };
    const auto is_here = [&](const std::string& name) {
        return name == mark.place || name.starts_with(mark.place + ".");
    };
    const bool bus = mark.place.ends_with(".i2c"), air = mark.place == "ether";
    return among(selection.links, is_here) && among(selection.nodes, is_here) &&
           among(selection.kinds,
                 [&](const std::string& kind) { return (bus && kind == "i2c") || (air && kind == "radio"); });
}

}  // namespace

FaultMarks::FaultMarks(const RecordedTrace& trace) {
    if (trace.file().filename() != "trace.csv") return;
    const std::filesystem::path path = trace.file().parent_path() / "faults.csv";
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return;
    std::ifstream in(path);
    std::string line;
    if (!std::getline(in, line) || line != kColumns)
        throw InputError(path.string(), "line 1", "no list of firings", std::string(kColumns));
    for (std::size_t number = 2; std::getline(in, line); ++number)
        if (auto mark = mark_of(line, path.string(), number); mark && in_time(trace.selection(), *mark))
            on_bytes_.emplace(std::pair{mark->place, mark->time}, *mark);
    if (on_bytes_.empty()) return;
    std::multimap<std::pair<std::string, cosim::Time>, FaultMark> found;
    I2cTransfers transfers([&](const I2cStep& step) {
        if (step.kind == I2cStep::Kind::Stop) return;
        for (auto [one, end] = on_bytes_.equal_range({step.bus, step.start}); one != end;)
            found.insert(on_bytes_.extract(one++));
    });
    RecordedTrace::Cursor cursor(trace);
    while (const auto row = cursor.next())
        if (const auto* phase = std::get_if<cosim::I2cPhase>(&row->payload)) transfers.add(*row, *phase);
    transfers.end();
    for (auto& [key, mark] : on_bytes_)
        if (is_wanted(trace.selection(), mark)) alone_.push_back(std::move(mark));
    on_bytes_ = std::move(found);
}

std::vector<const FaultMark*> FaultMarks::of_byte(const std::string& bus, cosim::Time start) const {
    std::vector<const FaultMark*> marks;
    const auto [first, last] = on_bytes_.equal_range({bus, start});
    for (auto one = first; one != last; ++one)
        marks.push_back(&one->second);
    return marks;
}

FaultMarkCursor::FaultMarkCursor(const FaultMarks& marks, Which which) {
    for (const FaultMark& mark : marks.alone_)
        marks_.push_back(&mark);
    if (which == All)
        for (const auto& [key, mark] : marks.on_bytes_)
            marks_.push_back(&mark);
    std::stable_sort(marks_.begin(), marks_.end(),
                     [](const FaultMark* a, const FaultMark* b) { return a->time < b->time; });
}

}  // namespace puckloop::tools
