// puckloop gap: simulation against measured data.

#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "base/logs/log.h"
#include "base/plain_text.h"
#include "emu/image/image.h"
#include "gap/begin/expected_time.h"
#include "gap/data/experiment.h"
#include "gap/findings/quantities.h"
#include "gap/kinds/columns.h"
#include "gap/overlay/overlay.h"
#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"
#include "gap/report/report.h"
#include "selftest/emulate/rerun.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/log_options.h"
#include "tools/cli/other_programs.h"
#include "tools/gap/folders.h"
#include "tools/gap/subcommands.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace puckloop::tools {

namespace {

constexpr double kBriefRerun = 40.0;  // s of simulated time

struct FitRequest {
    std::filesystem::path folder, out, firmware;
    std::uint64_t seed = 1;
    bool rerun = false, no_rerun = false;
    LogOptions log;
};

void tell_experiment(const gap::Experiment& experiment) {
    fmt::print("{}: kind {}, {} runs, {} rows\n", experiment.title, gap::kind_name(experiment.kind),
               experiment.runs.size(), experiment.rows());
    for (const auto& caution : experiment.cautions)
        fmt::print("caution: {}\n", caution);
}

/// The steps in the log if there is one; else one line that is written over, on a terminal only.
std::function<void(const std::string&, double)> progress_line(double expected) {
    const auto begun = std::chrono::steady_clock::now();
    const auto left = [begun, expected](double share) {
        const double elapsed =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        return gap::rough_time(gap::seconds_left(expected, elapsed, share));
    };
    if (log::wants(log::Level::Info))
        return [said = std::string(), left](const std::string& what, double share) mutable {
            if (what != said) log::info("{:.0f} %: {}; {} left", 100 * share, what, left(share));
            said = what;
        };
    if (::isatty(STDERR_FILENO) == 0) return {};
    return [left](const std::string& what, double share) {
        fmt::print(stderr, "\r\033[K{:3.0f} %, {} left: {}", 100 * share, left(share), what);
        std::fflush(stderr);
    };
}

void tell_verdict(const gap::Experiment& experiment, const gap::Verdict& verdict) {
    const auto& known = experiment.cautions;
    for (const auto& caution : verdict.cautions)
        if (std::find(known.begin(), known.end(), caution) == known.end())
            fmt::print("caution: {}\n", caution);
    fmt::print("verdict: {}\n{}\n", gap::decision_name(verdict.decision), verdict.summary);
    for (const auto& cause : verdict.causes)
        fmt::print("  {} ({}): {}\n", cause.name, cause.number, cause.sentence);
    for (const auto& rival : verdict.rivals)
        fmt::print("  rival of {}: {} ({}), delta BIC {:.1f}\n", rival.instead_of, rival.cause.name,
                   rival.cause.number, rival.delta_bic);
    for (const auto& one : verdict.extension.observables)
        fmt::print(
            "  error of {} on runs not fitted: {:.4g}{} as it is, {:.4g} with names, {:.4g} with the term "
            "that was learnt{}\n",
            gap::plain_observable(one.observable), one.before, gap::unit_suffix(one.unit), one.named,
            one.extended, one.kept ? "" : " (no clear gain)");
    if (!verdict.extension.sentence.empty()) fmt::print("{}\n", verdict.extension.sentence);
    constexpr double kLeastP = 1e-300;  // by a double no less
    constexpr std::size_t kLines = 6;   // the clearest come first; all are in gap.json and the report
    std::vector<std::string> printed;
    for (const auto& left : verdict.leftovers) {
        auto line = fmt::format("{} against {}: {}", gap::plain_observable(left.observable), left.covariate,
                                left.shape);
        if (std::find(printed.begin(), printed.end(), line) != printed.end()) continue;
        const auto p =
            left.p_value < kLeastP ? std::string("below 1e-300") : fmt::format("{:.2g}", left.p_value);
        if (printed.size() < kLines) fmt::print("  left: {} (p {})\n", line, p);
        printed.push_back(std::move(line));
    }
    if (printed.size() > kLines) fmt::print("  left: and {} more\n", printed.size() - kLines);
}

/// With the overlay as written, which is what anybody's run would load. Unasked: some seconds of it.
void run_again(const FitRequest& request, const gap::Experiment& experiment, gap::Verdict& verdict) {
    gap::emulate::RerunOptions options;
    options.tools = emulation_tools();
    options.overlay = std::filesystem::absolute(beside(request.out / "overlay.toml"));
    if (!request.firmware.empty()) options.firmware = std::filesystem::absolute(request.firmware);
    options.scratch = std::filesystem::absolute(request.out / fmt::format("rerun.{}", ::getpid()));
    options.seed = request.seed;
    if (!request.rerun) options.longest = kBriefRerun;
    if (::isatty(STDERR_FILENO) != 0)
        options.done = [](std::size_t done, std::size_t all) {
            fmt::print(stderr, "\r\033[K{} of {} runs again ", done, all);
        };
    verdict.rerun = gap::emulate::rerun(experiment, verdict, options);
    if (options.done) fmt::print(stderr, "\r\033[K");
    if (!verdict.rerun.not_done.empty()) fmt::print("not run again: {}\n", verdict.rerun.not_done);
    for (const auto& one : verdict.rerun.observables)
        fmt::print("run again with the overlay ({} of {} runs or placements): {}, error {:.4g}{} before, "
                   "{:.4g} after\n",
                   verdict.rerun.runs, verdict.rerun.of_runs, one.name, one.before,
                   gap::unit_suffix(one.unit), one.after);
    if (const auto caution = verdict.rerun.caution(); !caution.empty()) fmt::print("  {}\n", caution);
}

void analyse_folder(const FitRequest& request) {
    if (request.rerun && request.out.empty())
        throw InputError("", "--rerun", "needs the overlay that --out writes", "--out OUT");
    if (request.rerun && request.no_rerun)
        throw InputError("", "--no-rerun", "says the contrary of --rerun", "one of the two");
    if (request.no_rerun && !request.firmware.empty())
        throw InputError("", "--firmware", "is for running again only", "no --no-rerun");
    if (!request.firmware.empty()) {  // said now, not after the analysis
        if (request.out.empty())
            throw InputError("", "--firmware", "needs the overlay that --out writes", "--out OUT");
        image::load_image(request.firmware.string());
    }
    const gap::Experiment experiment = gap::read_experiment(request.folder);
    log::info("read {}: kind {}, {} runs, {} rows", request.folder.string(), gap::kind_name(experiment.kind),
              experiment.runs.size(), experiment.rows());
    const auto overlay = request.out / "overlay.toml", json = request.out / "gap.json",
               page = request.out / "report.html", checks = request.out / "predictive.svg";
    if (!request.out.empty()) {
        prepare_folder(request.out);
        for (const auto& file : {overlay, json, page, checks})
            if (std::filesystem::is_directory(file))
                throw InputError(file.string(), "", "is a folder", "a file, or nothing yet");
        claim_folder(request.out, ".puckloop-gap",
                     {"overlay.toml", "gap.json", "report.html", "predictive.svg"});
    }
    const unsigned threads = std::max(1U, std::thread::hardware_concurrency());
    gap::Options options{request.seed, threads,
                         progress_line(gap::expected_time(experiment, threads).something)};
    const auto begun = std::chrono::steady_clock::now();
    gap::Verdict verdict = gap::analyse(experiment, options);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    log::info("analysed in {:.2f} s: {}", took.count(), gap::decision_name(verdict.decision));
    if (::isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r\033[K");
    tell_experiment(experiment);
    tell_verdict(experiment, verdict);
    if (request.out.empty()) return;
    write_beside(overlay, gap::overlay_toml(experiment, verdict));
    if (request.rerun || (!request.no_rerun && (!verdict.causes.empty() || verdict.extension.enters())))
        run_again(request, experiment, verdict);
    write_beside(json, gap::to_json(verdict));
    write_beside(page, gap::report::report_html(experiment, verdict));
    write_beside(checks, gap::report::predictive_svg(verdict));
    for (const auto& file : {overlay, json, page, checks})
        put_in_place(file);
    fmt::print("report in {}\n", plain_text(page.string(), kLongestMessage));
}

}  // namespace

void declare_gap(Command& app, int& status) {
    auto* command = app.add_subcommand("gap", about("gap"));
    auto request = std::make_shared<FitRequest>();
    command
        ->add_option("folder", request->folder,
                     "measured experiment: a folder with experiment.toml (docs/gap.md)")
        ->type_name("DIR");
    command
        ->add_option("--out", request->out,
                     "folder for report.html, predictive.svg, gap.json and overlay.toml")
        ->type_name("OUT")
        ->check(not_empty());
    command->add_option("--seed", request->seed, "of everything random in the analysis")
        ->check(count_up_to(kLargestSeed))
        ->type_name("N");
    command->add_flag("--rerun", request->rerun,
                      "perform the whole experiment again on the emulator, without and with the overlay; "
                      "unasked some 40 s of it");
    command->add_flag("--no-rerun", request->no_rerun, "do not perform any of it again");
    command
        ->add_option("--firmware", request->firmware,
                     "of the main board, for what is performed again (the project's own)")
        ->type_name("IMAGE");
    declare_log_options(*command, request->log);
    command->require_subcommand(0, 1);
    declare_gap_new(*command, status);
    declare_gap_mission(*command, status);
    declare_gap_power(*command, status);
    declare_gap_check(*command, status);
    declare_gap_import(*command, status);
    declare_gap_record(*command, status);
    declare_gap_selftest(*command, status);
    command->callback([command, request, &status] {
        if (command->subcommand_given()) return;
        if (request->folder.empty())
            throw InputError("", "", "gap: no folder", "DIR, a folder with experiment.toml");
        start_log("gap", request->log);
        analyse_folder(*request);
        status = 0;
    });
}

}  // namespace puckloop::tools
