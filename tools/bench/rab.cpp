// `puckloop bench rab`: range and bearing as emulated boards read them, beside the published table.

#include "tools/bench/rab.h"
#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "base/files/text_file.h"
#include "cosim/interrupt.h"
#include "physics/ir/published_strengths.h"
#include "reproductions/rab/measure.h"
#include "reproductions/rab/picture.h"
#include "tools/bench/assignment.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <memory>

namespace puckloop::tools {

namespace {

constexpr double kCentimetres = 100;

struct RabOptions {
    RabMeasurement measurement;
    std::vector<double> distances_cm;
    std::vector<std::string> parameters;
    std::filesystem::path out = "out/rab";
};

std::string readings_csv(const RabMeasured& measured, const std::vector<double>& distances) {
    std::string csv = "distance_cm,sender,received,late,strength,bearing_rad,bearing_true_rad\n";
    for (const RabReadingRow& row : measured.rows)
        csv += fmt::format("{:g},{},{},{},{},{:.4f},{:.4f}\n", distances[row.distance] * kCentimetres,
                           row.sender, row.received ? 1 : 0, row.late ? 1 : 0, row.range, row.bearing,
                           row.bearing_true);
    return csv;
}

void run_rab(RabOptions& options, int& status) {
    RabMeasurement& what = options.measurement;
    if (options.distances_cm.empty())
        for (const auto& entry : physics::kPublishedStrengths)
            what.distances.push_back(entry.distance);
    for (const double centimetres : options.distances_cm)
        what.distances.push_back(centimetres / kCentimetres);
    what.parameters = assignments_of(options.parameters);
    claim_folder(options.out, ".puckloop-bench", {"rab_errors.csv", "rab_readings.csv", "rab_errors.svg"});
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const cosim::InterruptGuard interrupt;
    const RabMeasured measured = measure_rab(
        what,
        [terminal](double share) {
            if (terminal) fmt::print(stderr, "\r{:3.0f} %", 100 * share);
        },
        interrupt.flag());
    if (terminal) fmt::print(stderr, "\r     \r");
    const auto summary = summarise(measured.rows, what.distances);
    write_file(options.out / "rab_errors.csv", summary_csv(summary));
    write_file(options.out / "rab_readings.csv", readings_csv(measured, what.distances));
    write_file(
        options.out / "rab_errors.svg",
        rab_picture(summary, fmt::format("{}, {} pairs of boards, {} frames a distance, potentiometer {}",
                                         what.firmware.filename().string(), what.pairs,
                                         2 * what.pairs * what.repeats, what.power)));
    fmt::print("{}{:.1f} simulated seconds in {:.1f} s; {}\n", summary_text(summary), measured.simulated_s,
               measured.wall_s, options.out.string());
    status = 0;
}

}  // namespace

void declare_bench_rab(Command& bench, int& status) {
    Command* command = bench.add_subcommand(
        "rab", "range and bearing of two emulated boards against distance, as picture and table");
    auto options = std::make_shared<RabOptions>();
    RabMeasurement& what = options->measurement;
    command->add_option("--firmware", what.firmware, "image of the boards' firmware")
        ->required()
        ->type_name("IMAGE");
    command
        ->add_option("--distance", options->distances_cm,
                     "between the bodies, cm (default: the table's nine)")
        ->check(number_between(0, 250))
        ->type_name("CM");
    command->add_option("--pairs", what.pairs, "pairs of boards, each with parts of its own")
        ->check(whole_number_between(1, 1000))
        ->type_name("N");
    command->add_option("--repeats", what.repeats, "poses of each pair at each distance, two frames each")
        ->check(whole_number_between(1, 10000))
        ->type_name("N");
    command->add_option("--power", what.power, "potentiometer byte, 0 = strongest")
        ->check(whole_number_between(0, 255))
        ->type_name("BYTE");
    command->add_option("--seed", what.seed, "of headings and parts")
        ->check(count_up_to(1'000'000'000))
        ->type_name("N");
    command->add_option("--set", options->parameters, "a physical parameter over its default (repeatable)")
        ->type_name("NAME=NUMBER");
    command->add_option("--out", options->out, "folder for the results")->type_name("DIR");
    command->callback([options, &status] { run_rab(*options, status); });
}

}  // namespace puckloop::tools
