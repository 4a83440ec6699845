// `puckloop trace export`: a recorded trace for sigrok, Wireshark, GTKWave or a spreadsheet.

#include "base/error.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/time_check.h"
#include "tools/records/trace_parts.h"
#include "traces/formats/export.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace puckloop::tools {

namespace {

constexpr double kMostRate = 1e9;        // Hz
constexpr double kLatestExported = 9e6;  // s

struct ExportOptions {
    std::string trace, format, output, timescale;
    TraceSelection selection;
    double rate = 0.0;
};

std::string format_of(const ExportOptions& options) {
    if (!options.format.empty()) return options.format;
    const std::string suffix = std::filesystem::path(options.output).extension().string();
    for (const char* known : {"csv", "pcapng", "sr", "vcd"})
        if (suffix == std::string(".") + known) return known;
    throw InputError("", "--format",
                     fmt::format("not given, and {} does not end in one of the formats", options.output),
                     "csv, pcapng, sr or vcd");
}

void run_export(const ExportOptions& options) {
    const std::string format = format_of(options);
    if (options.rate != 0.0 && format != "sr")
        throw InputError("", "--rate", fmt::format("a {} file has no sample rate", format), "--format sr");
    if (!options.timescale.empty() && format != "vcd")
        throw InputError("", "--timescale", fmt::format("a {} file has none", format), "--format vcd");
    const RecordedTrace trace(options.trace, options.selection);
    std::error_code error;
    if (options.output != "-" && std::filesystem::equivalent(trace.file(), options.output, error))
        throw InputError(options.output, "--output", "is the trace itself", "another file");
    check_output_file(options.output);
    if (format == "sr") return export_sr(trace, options.output, static_cast<std::uint64_t>(options.rate));
    // What cannot be read is reported before a file is made of it.
    RecordedTrace::Cursor(trace).next();
    write_output(options.output, [&](std::ostream& out) {
        if (format == "csv") return export_csv(trace, out);
        if (format == "vcd") return export_vcd(trace, out, options.timescale);
        export_pcapng(trace, out);
    });
}

}  // namespace

void add_selection(Command& command, TraceSelection& selection) {
    command.add_option("--link", selection.links, "only these links (repeatable)")->allow_extra_args(false);
    command.add_option("--from-node", selection.nodes, "only what these nodes sent (repeatable)")
        ->allow_extra_args(false);
    command.add_option("--kind", selection.kinds, "only these kinds (repeatable)")
        ->allow_extra_args(false)
        ->check(one_of({"uart", "i2c", "signal", "radio", "can", "packet"}));
    command.add_option("--from", selection.from_s, "first time, s")
        ->check(seconds_between(0.0, kLatestExported));
    command.add_option("--to", selection.until_s, "end time, s; not included")
        ->check(seconds_between(0.0, kLatestExported));
}

void declare_trace_export(Command& trace) {
    auto options = std::make_shared<ExportOptions>();
    Command* command = trace.add_subcommand(
        "export", "write a trace for sigrok (sr), Wireshark (pcapng), GTKWave (vcd) or as csv");
    command->add_option("trace", options->trace, "results folder of a run, or its trace.csv")
        ->required()
        ->type_name("DIR");
    command->add_option("-o,--output", options->output, "the file; - is the standard output")
        ->required()
        ->type_name("FILE");
    command->add_option("--format", options->format, "sr, pcapng, vcd or csv; else by the file's name")
        ->check(one_of({"sr", "pcapng", "vcd", "csv"}));
    command->add_option("--rate", options->rate, "samples per second of an sr file; else 16 or more a bit")
        ->check(number_between(1.0, kMostRate));
    command
        ->add_option("--timescale", options->timescale,
                     "unit of a vcd file's times, 1 us to 1 ps; else 16 or more a bit")
        ->check(one_of({"1 us", "100 ns", "10 ns", "1 ns", "100 ps", "10 ps", "1 ps"}))
        ->type_name("UNIT");
    add_selection(*command, options->selection);
    command->callback([options] { run_export(*options); });
}

}  // namespace puckloop::tools
