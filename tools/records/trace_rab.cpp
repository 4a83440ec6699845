// `puckloop trace rab DIR`: which range-and-bearing frames of a run became messages, and why the others did
// not.

#include "tools/records/trace_parts.h"

#include "base/error.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/time_check.h"
#include "traces/rab_losses/results.h"

#include <fmt/format.h>

#include <memory>

namespace puckloop::tools {

namespace {

constexpr double kLatestOfRab = 9e6;  // s

struct TraceRabOptions {
    std::string folder;
    double from_s = 0.0, until_s = kLatestOfRab;
    double bin_cm = 10.0;
    bool json = false;
};

}  // namespace

void declare_trace_rab(Command& trace) {
    auto options = std::make_shared<TraceRabOptions>();
    Command* command =
        trace.add_subcommand("rab", "range-and-bearing frames of a run: delivered, lost, and why");
    command->add_option("folder", options->folder, "results folder of a run")->required()->type_name("DIR");
    command->add_option("--from", options->from_s, "first time, s")
        ->check(seconds_between(0.0, kLatestOfRab));
    command->add_option("--to", options->until_s, "end time, s; not included")
        ->check(seconds_between(0.0, kLatestOfRab));
    command->add_option("--bin", options->bin_cm, "width of a class of distances, cm")
        ->check(positive_number());
    command->add_flag("--json", options->json, "print JSON");
    command->callback([options] {
        constexpr double kCmOfM = 100.0;
        if (options->until_s <= options->from_s)
            throw InputError("--to", "", fmt::format("{} s is not after --from", options->until_s),
                             fmt::format("more than {} s", options->from_s));
        const RabResults results = read_rab_results(options->folder, options->from_s, options->until_s);
        const double bin = options->bin_cm / kCmOfM;
        fmt::print("{}", options->json ? to_json(results, bin) : to_text(results, bin));
    });
}

}  // namespace puckloop::tools
