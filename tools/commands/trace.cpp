// puckloop trace: reads a recorded trace.csv; filters it, counts it, or writes it in another form.

#include "base/error.h"
#include "cosim/trace/trace_csv.h"
#include "cosim/trace/trace_stats.h"
#include "cosim/trace/trace_vcd.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/commands/trace_rab.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <set>

namespace puckloop::tools {

namespace {

using cosim::TraceRow;

struct Options {
    std::string file;
    std::vector<std::string> links, nodes, kinds;
    double from_s = 0.0;
    double until_s = 9e6;
    std::string csv, vcd;
    bool json = false;
};

std::string kind_of(const TraceRow& row) {
    constexpr const char* kKinds[] = {"uart", "i2c", "signal", "radio"};
    return kKinds[row.payload.index()];
}

bool wanted(const TraceRow& row, const Options& options) {
    const auto among = [](const std::vector<std::string>& list, const std::string& name) {
        return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
    };
    return row.time >= cosim::from_seconds(options.from_s) &&
           row.time < cosim::from_seconds(options.until_s) && among(options.links, row.link) &&
           among(options.nodes, row.from) && among(options.kinds, kind_of(row));
}

/// "-" is the standard output.
void write_to(const std::string& path, const std::function<void(std::ostream&)>& write) {
    std::ofstream file;
    if (path != "-") file.open(path, std::ios::binary);
    std::ostream& out = path == "-" ? std::cout : file;
    errno = 0;
    if (out) write(out);
    out.flush();
    if (!out)
        throw RunError(fmt::format("{}: cannot write: {}", path, std::strerror(errno != 0 ? errno : EIO)));
}

void check_known(const char* option, const std::vector<std::string>& asked,
                 const std::set<std::string>& known) {
    for (const std::string& name : asked)
        if (!known.contains(name))
            throw InputError("", option, fmt::format("'{}' does not occur in the trace", name),
                             fmt::format("one of {}", fmt::join(known, ", ")));
}

void run(const Options& options) {
    if (options.file.empty())
        throw InputError("", "trace", "no file given", "trace.csv of a run, or rab and its results folder");
    std::ifstream in(options.file, std::ios::binary);
    if (!in) throw InputError(options.file, "", std::strerror(errno), "a trace.csv that a run recorded");
    std::vector<TraceRow> rows;
    cosim::TraceStats stats;
    std::set<std::string> links, nodes;
    const bool whole = cosim::read_trace(in, options.file, [&](const TraceRow& row) {
        links.insert(row.link);
        nodes.insert(row.from);
        if (!wanted(row, options)) return;
        stats.add(row);
        if (!options.csv.empty() || !options.vcd.empty()) rows.push_back(row);
    });
    if (!whole)
        std::fprintf(stderr, "puckloop: %s: the last line is incomplete and left out\n",
                     options.file.c_str());
    check_known("--link", options.links, links);
    check_known("--from-node", options.nodes, nodes);
    if (!options.csv.empty())
        write_to(options.csv, [&](std::ostream& out) {
            out << cosim::kTraceColumns << '\n';
            for (const TraceRow& row : rows)
                out << to_csv(row) << '\n';
        });
    if (!options.vcd.empty())
        write_to(options.vcd, [&](std::ostream& out) {
            cosim::VcdWriter vcd;
            for (const TraceRow& row : rows)
                vcd.add(row);
            vcd.write(out);
        });
    if (options.csv.empty() && options.vcd.empty())
        fmt::print("{}", options.json ? stats.json() : stats.text());
}

}  // namespace

void declare_trace(Command& app, int&) {
    auto options = std::make_shared<Options>();
    Command* command = app.add_subcommand(
        "trace", "read a recorded trace: count, filter, convert; without --csv or --vcd, counts");
    command->add_option("file", options->file, "trace.csv of a run");
    command->add_option("--link", options->links, "only these links (repeatable)")->allow_extra_args(false);
    command->add_option("--from-node", options->nodes, "only what these nodes sent (repeatable)")
        ->allow_extra_args(false);
    command->add_option("--kind", options->kinds, "only uart, i2c, signal or radio (repeatable)")
        ->allow_extra_args(false)
        ->check(one_of({"uart", "i2c", "signal", "radio"}));
    command->add_option("--from", options->from_s, "first time, s")->check(number_between(0.0, 9e6));
    command->add_option("--to", options->until_s, "end time, s; not included")
        ->check(number_between(0.0, 9e6));
    command->add_option("--csv", options->csv, "write the filtered trace; - is the standard output");
    command->add_option("--vcd", options->vcd,
                        "write a value change dump, for GTKWave; - is the standard output");
    command->add_flag("--json", options->json, "counts as JSON");
    declare_trace_rab(*command);
    command->callback([command, options] {
        if (!command->subcommand_given()) run(*options);
    });
}

}  // namespace puckloop::tools
