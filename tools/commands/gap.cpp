// puckloop gap: simulation against measured data.

#include "tools/commands/gap.h"
#include "base/error.h"
#include "gap/experiment.h"
#include "tools/command.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace puckloop::tools {

namespace {

struct Request {
    std::filesystem::path folder, out;
    std::uint64_t seed = 1;
};

void tell_experiment(const gap::Experiment& experiment) {
    fmt::print("{}: kind {}, {} runs, {} rows\n", experiment.title, gap::kind_name(experiment.kind),
               experiment.runs.size(), experiment.rows());
    for (const auto& caution : experiment.cautions)
        fmt::print("caution: {}\n", caution);
}

}  // namespace

void declare_gap(CLI::App& app, int& status) {
    auto* command =
        app.add_subcommand("gap", "simulation against measured data: what is wrong, why, and what is gained");
    auto request = std::make_shared<Request>();
    command
        ->add_option("folder", request->folder,
                     "measured experiment: a folder with experiment.toml (docs/gap.md)")
        ->type_name("DIR");
    command->add_option("--out", request->out, "folder for report.html, gap.json and overlay.toml")
        ->type_name("OUT");
    command->add_option("--seed", request->seed, "of everything random in the analysis")->type_name("N");
    command->require_subcommand(0, 1);
    declare_gap_import(*command, status);
    declare_gap_record(*command, status);
    command->callback([command, request, &status] {
        if (!command->get_subcommands().empty()) return;
        if (request->folder.empty())
            throw InputError("", "", "gap: no folder", "DIR, a folder with experiment.toml");
        tell_experiment(gap::read_experiment(request->folder));
        status = 0;
    });
}

}  // namespace puckloop::tools
