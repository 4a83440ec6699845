#include "traces/rab_losses/results.h"

#include "base/error.h"
#include "base/text/csv.h"
#include "cosim/trace/trace_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

namespace puckloop::tools {

namespace {

constexpr std::string_view kBoardLink = ".i2c.rab";  // robot0.i2c.rab
constexpr std::string_view kFrameColumns =
    "t_s,end_s,sender,receiver,distance_m,level_counts,carrier,receivers,heard,overlap,receiver_sending";
constexpr std::size_t kColumns = 11;
constexpr double kRounding = 1e-9;  // 0.3 / 0.1 belongs to the class that begins there

double number(std::string_view cell, const std::string& file, std::size_t line) {
    double value = 0.0;
    if (!csv_number(cell, value))
        throw InputError(file, fmt::format("line {}", line), fmt::format("'{}' is no number", cell));
    return value;
}

std::vector<HeardFrame> read_frames(const std::filesystem::path& path, double from_s, double to_s) {
    const std::string file = path.string();
    std::ifstream in(path);
    std::string line;
    if (!in || !std::getline(in, line))
        throw InputError(file, "", "cannot be read", "the ir.csv of a run with range-and-bearing boards");
    if (line != kFrameColumns) throw InputError(file, "line 1", "other columns", std::string(kFrameColumns));
    std::vector<HeardFrame> frames;
    for (std::size_t n = 2; std::getline(in, line); ++n) {
        const auto cells = csv_cells(line, ',');
        if (cells.size() != kColumns) {
            if (in.eof()) break;  // no newline: the writer was killed in the middle of a line
            throw InputError(file, fmt::format("line {}", n), "wrong number of columns",
                             fmt::format("{}", kColumns));
        }
        const double start = number(cells[0], file, n);
        if (start < from_s || start >= to_s) continue;
        HeardFrame frame;
        frame.start = cosim::from_seconds(start);
        frame.end = cosim::from_seconds(number(cells[1], file, n));
        frame.sender = cells[2];
        frame.receiver = cells[3];
        frame.distance = number(cells[4], file, n);
        frame.heard = number(cells[8], file, n) != 0;
        frame.overlapped = !cells[9].empty();
        frame.receiver_sending = number(cells[10], file, n) != 0;
        frames.push_back(frame);
    }
    return frames;
}

void add(RabGroup& group, const Fate& fate) {
    ++group.frames;
    group.distance += (fate.frame.distance - group.distance) / static_cast<double>(group.frames);
    if (fate.delivered)
        ++group.delivered;
    else
        ++group.lost[static_cast<std::size_t>(fate.cause)];
    for (std::size_t c = 0; c < kCauses; ++c) {
        if (!fate.met[c]) continue;
        ++group.met[c];
        group.met_lost[c] += fate.delivered ? 0 : 1;
    }
}

}  // namespace

RabResults read_rab_results(const std::filesystem::path& folder, double from_s, double to_s) {
    RabResults results;
    const auto frames = read_frames(folder / "ir.csv", from_s, to_s);
    const std::filesystem::path trace = folder / "trace.csv";
    std::ifstream in(trace, std::ios::binary);
    if (!in) throw InputError(trace.string(), "", "cannot be read", "the trace.csv of a run");
    std::map<std::string, BoardBus> buses;
    cosim::Time last = 0;
    cosim::read_trace(in, trace.string(), [&](const cosim::TraceRow& row) {
        last = row.time;
        if (!row.link.ends_with(kBoardLink)) return;
        buses[row.link.substr(0, row.link.size() - kBoardLink.size())].add(row);
    });
    const auto outside = [&](const auto& event) {
        const double time = cosim::to_seconds(event.time);
        return time < from_s || time >= to_s;
    };
    for (const auto& [robot, bus] : buses) {
        BoardTraffic& traffic = results.boards[robot];
        traffic = {bus.busy(), sends_of(bus.accesses()), polls_of(bus.accesses())};
        std::erase_if(traffic.sends, outside);
        std::erase_if(traffic.polls, outside);
    }
    std::map<std::string, std::set<cosim::Time>> starts;
    for (const HeardFrame& frame : frames)
        starts[frame.sender].insert(frame.start);
    std::map<std::string, std::vector<cosim::Time>> rising;
    for (const auto& [sender, times] : starts) {
        results.on_air[sender] = times.size();
        rising[sender].assign(times.begin(), times.end());
    }
    results.locked = locked_phases(rising);
    results.from_s = from_s;
    results.to_s = std::min(to_s, cosim::to_seconds(last));
    results.losses = explain(frames, results.boards, cosim::from_seconds(results.to_s));
    return results;
}

std::vector<RabGroup> groups_of(const Losses& losses, double bin) {
    RabGroup all;
    all.name = "all";
    std::map<std::string, RabGroup> pairs;
    std::map<long, RabGroup> bins;
    for (const Fate& fate : losses.fates) {
        add(all, fate);
        add(pairs[fate.frame.sender + " -> " + fate.frame.receiver], fate);
        add(bins[std::lround(std::floor(fate.frame.distance / bin + kRounding))], fate);
    }
    std::vector<RabGroup> groups{all};
    for (auto& [name, group] : pairs) {
        group.name = name;
        groups.push_back(group);
    }
    for (auto& [index, group] : bins) {
        group.name = fmt::format("{:g} to {:g} cm", static_cast<double>(index) * bin * 100.0,
                                 static_cast<double>(index + 1) * bin * 100.0);
        groups.push_back(group);
    }
    return groups;
}

}  // namespace puckloop::tools
