// puckloop gap new, puckloop gap check: a folder to be filled, and whether it is ready.

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "gap/begin/new_folder.h"
#include "gap/begin/readiness.h"
#include "gap/kinds/read_kind.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/gap/subcommands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

namespace puckloop::tools {

namespace {

constexpr std::uint64_t kMostRuns = 1000;

struct Fresh {
    std::string kind;
    std::filesystem::path folder;
    std::uint64_t runs = 6;
};

}  // namespace

gap::Kind kind_asked(const std::string& text) {
    std::error_code failed;
    if (gap::names_kind_file(text) && !std::filesystem::exists(text, failed))
        if (const auto shipped = shipped_file("scenarios/kinds/" + text); !shipped.empty())
            return gap::read_kind(shipped);
    return gap::kind_stated(text, "", "", "gap new");
}

namespace {

void make_folder(const Fresh& fresh) {
    const gap::Kind kind = kind_asked(fresh.kind);
    if (fresh.runs == 0) throw InputError("", "--runs", "is 0", "1 or more");
    gap::write_new_folder(kind, fresh.runs, fresh.folder);
    fmt::print(
        "{}: experiment.toml and {} CSV file{} with a header\nfill them in, then: puckloop gap check {}\n",
        fresh.folder.string(), fresh.runs, fresh.runs == 1 ? "" : "s", fresh.folder.string());
}

}  // namespace

void declare_gap_new(Command& gap, int& status) {
    Command* command =
        gap.add_subcommand("new", "Write a commented experiment.toml and CSV headers, to be filled in");
    auto fresh = std::make_shared<Fresh>();
    command->add_option("kind", fresh->kind, gap::kKindNames)->type_name("KIND")->required();
    command->add_option("folder", fresh->folder, "a new folder")
        ->type_name("DIR")
        ->check(not_empty())
        ->required();
    command->add_option("--runs", fresh->runs, "CSV files, one per run")
        ->check(count_up_to(kMostRuns))
        ->type_name("N");
    command->callback([fresh, &status] {
        status = 0;
        make_folder(*fresh);
    });
}

void declare_gap_check(Command& gap, int& status) {
    Command* command = gap.add_subcommand(
        "check",
        "What is wrong with an experiment or missing in it, at once; status 2 where it cannot be used");
    auto folder = std::make_shared<std::filesystem::path>();
    command->add_option("folder", *folder, "measured experiment: a folder with experiment.toml")
        ->type_name("DIR")
        ->check(not_empty())
        ->required();
    command->callback([folder, &status] {
        const auto ready = gap::readiness_of(*folder, std::max(1U, std::thread::hardware_concurrency()));
        fmt::print("{}", gap::readiness_text(ready));
        status = ready.problems.empty() ? 0 : 2;
    });
}

}  // namespace puckloop::tools
