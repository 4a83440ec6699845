// `puckloop bench bluetooth`: how long exchanges between two Bluetooth modules take and how often they fail,
// beside what was published.

#include "tools/bench/bluetooth.h"
#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "base/files/text_file.h"
#include "emu/bluetooth/exchange.h"
#include "reproductions/exchange_boards.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::tools {

namespace {

using bluetooth::Exchange;

struct BluetoothOptions {
    unsigned exchanges = 1000;
    bool boards = false;
    std::filesystem::path firmware;
    std::uint64_t seed = 1;
    std::filesystem::path out = "out/bluetooth_times";
};

ExchangeTimes summary_of(const std::vector<Exchange>& exchanges) {
    ExchangeTimes times;
    times.attempts = exchanges.size();
    for (const Exchange& one : exchanges) {
        if (!one.found)
            ++times.not_found;
        else if (!one.arrived)
            ++times.failed_later;
        else
            times.totals.push_back(one.total);
    }
    summarise(times);
    return times;
}

std::string csv(const std::vector<Exchange>& exchanges) {
    std::string rows = "exchange,found,linked,arrived,inquiry_s,name_s,link_s,release_s,total_s\n";
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
        const Exchange& one = exchanges[i];
        rows += fmt::format("{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", i, one.found ? 1 : 0,
                            one.linked ? 1 : 0, one.arrived ? 1 : 0, one.inquiry, one.name, one.link,
                            one.release, one.total);
    }
    return rows;
}

/// Modules with a host in this program.
ExchangeTimes by_modules(const BluetoothOptions& options) {
    std::vector<Exchange> exchanges;
    exchanges.reserve(options.exchanges);
    for (unsigned i = 0; i < options.exchanges; ++i)
        exchanges.push_back(bluetooth::exchange({}, options.seed, i));
    write_file(options.out / "exchanges.csv", csv(exchanges));
    return summary_of(exchanges);
}

/// Emulated boards with the firmware in the loop.
ExchangeTimes by_boards(const BluetoothOptions& options) {
    const auto exchanges =
        exchange_on_boards({options.firmware, options.out / "run", options.exchanges, options.seed});
    write_file(options.out / "exchanges.csv", exchanges_csv(exchanges));
    return times_of(exchanges);
}

void run_bluetooth(const BluetoothOptions& options, int& status) {
    if (options.boards == options.firmware.empty())
        throw InputError("", "bench bluetooth", "emulated boards need a program, and nothing else does",
                         "--boards and --firmware IMAGE together");
    claim_folder(options.out, ".puckloop-bench", {"exchanges.csv", "exchanges.svg", "trials"});
    const ExchangeTimes times = options.boards ? by_boards(options) : by_modules(options);
    const std::string name = options.boards ? options.firmware.filename().string() : "drawn";
    write_file(options.out / "exchanges.svg", exchange_picture(times, name));
    fmt::print("{}{}\n", exchange_table(times, name), (options.out / "exchanges.svg").string());
    status = 0;
}

}  // namespace

void declare_bench_bluetooth(Command& bench, int& status) {
    Command* command = bench.add_subcommand(
        "bluetooth", "how long exchanges by Bluetooth take and how often they fail, as picture and table");
    auto options = std::make_shared<BluetoothOptions>();
    command
        ->add_option(
            "--exchanges", options->exchanges,
            "between two modules, each from power-up (default 1000); with --boards, one after the other")
        ->check(whole_number_between(1, 1'000'000))
        ->type_name("N");
    command->add_flag("--boards", options->boards,
                      "two emulated boards run a program that calls and listens");
    command
        ->add_option("--firmware", options->firmware,
                     "of --boards: calls at selector 1, listens at 0, reports to UART2, such as "
                     "firmware/bluetooth/talk.hex")
        ->type_name("IMAGE");
    command->add_option("--seed", options->seed, "of what is drawn")
        ->check(count_up_to(1'000'000'000))
        ->type_name("N");
    command->add_option("--out", options->out, "folder for the results")->type_name("DIR");
    command->callback([options, &status] { run_bluetooth(*options, status); });
}

}  // namespace puckloop::tools
