#pragma once
// Two emulated main boards that talk by Bluetooth again and again, as firmware/bluetooth does: one calls, the
// other listens and answers.

#include "reproductions/exchange_log.h"
#include "reproductions/exchange_times.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace puckloop::tools {

struct BoardExchanges {
    std::filesystem::path firmware;  ///< calls at selector 1, listens at 0, reports to UART2
    std::filesystem::path folder;    ///< where the run leaves its results
    std::size_t attempts = 58;
    std::uint64_t seed = 1;
};

/// The first `attempts` that end within the simulated time that so many take. Throws RunError where none
/// does.
std::vector<ReportedExchange> exchange_on_boards(const BoardExchanges& options);

ExchangeTimes times_of(const std::vector<ReportedExchange>& exchanges);

/// "exchange,ended_s,outcome,name_s,link_s,release_s,total_s", one line per attempt; a part that was not
/// reached is empty.
std::string exchanges_csv(const std::vector<ReportedExchange>& exchanges);

}  // namespace puckloop::tools
