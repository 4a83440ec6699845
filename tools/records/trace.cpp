// puckloop trace: reads a recorded trace.csv; filters it, counts it, or writes it in another form.

#include "base/error.h"
#include "cosim/trace/trace_stats.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/records/records.h"
#include "tools/records/trace_parts.h"
#include "traces/fault_marks.h"
#include "traces/formats/export.h"
#include "traces/recorded_trace.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>

namespace puckloop::tools {

namespace {

struct TraceOptions {
    std::string file;
    TraceSelection selection;
    std::string csv, vcd;
    bool json = false;
};

/// What the table cannot count.
std::string unmarked_faults(const RecordedTrace& trace) {
    const FaultMarks marks(trace);
    std::map<std::string, std::size_t> places;
    FaultMarkCursor cursor(marks, FaultMarkCursor::All);
    while (const FaultMark* mark = cursor.next(cosim::kNever))
        ++places[mark->place];
    std::string text;
    for (const auto& [place, count] : places)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", place, count);
    return text.empty() ? "" : fmt::format("faults that are in no row (faults.csv): {}\n", text);
}

void run_trace(const TraceOptions& options) {
    if (options.file.empty())
        throw InputError("", "trace", "no file given",
                         "trace.csv of a run or its results folder, or one of export, decode and rab");
    const RecordedTrace trace(options.file, options.selection);
    for (const std::string& output : {options.csv, options.vcd})
        if (!output.empty()) check_output_file(output);
    if (!options.csv.empty()) write_output(options.csv, [&](std::ostream& out) { export_csv(trace, out); });
    if (!options.vcd.empty()) write_output(options.vcd, [&](std::ostream& out) { export_vcd(trace, out); });
    if (!options.csv.empty() || !options.vcd.empty()) return;
    cosim::TraceStats stats;
    trace.for_each_checked([&](const cosim::TraceRow& row) { stats.add(row); });
    fmt::print("{}", options.json ? stats.json() : stats.text() + unmarked_faults(trace));
}

}  // namespace

void declare_trace(Command& app, int&) {
    auto options = std::make_shared<TraceOptions>();
    Command* command = app.add_subcommand("trace", about("trace"));
    command->add_option("file", options->file, "trace.csv of a run, or its results folder");
    add_selection(*command, options->selection);
    command->add_option("--csv", options->csv, "write the filtered trace; - is the standard output");
    command->add_option("--vcd", options->vcd,
                        "write a value change dump, for GTKWave; - is the standard output");
    command->add_flag("--json", options->json, "counts as JSON");
    declare_trace_decode(*command);
    declare_trace_export(*command);
    declare_trace_rab(*command);
    command->callback([command, options] {
        if (!command->subcommand_given()) run_trace(*options);
    });
}

}  // namespace puckloop::tools
