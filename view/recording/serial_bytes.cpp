#include "view/recording/serial_bytes.h"

#include "base/json.h"
#include "base/text/csv.h"
#include "cosim/faults/spec/fault_kind.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <vector>

namespace puckloop::view {

namespace {

using nlohmann::ordered_json;

// Columns of trace.csv.
constexpr std::size_t kTime = 0, kLink = 1, kFrom = 2, kKind = 3, kValue = 4, kFault = 9, kColumns = 10;

struct SerialRows {
    std::vector<std::string> senders;
    std::vector<double> times;
    std::vector<std::size_t> from;
    std::vector<std::uint32_t> values;
    std::vector<int> kinds;

    void take(std::string_view line, std::string_view link) {
        const auto cells = csv_cells(line, ',');
        double time = 0.0;
        if (cells.size() != kColumns || cells[kLink] != link || !csv_number(cells[kTime], time)) return;
        const bool is_break = cells[kKind] == "break";
        if (!is_break && cells[kKind] != "uart") return;
        std::uint32_t value = 0;
        const std::string_view digits = cells[kValue];
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
        if (!is_break && (error != std::errc() || end != digits.data() + digits.size())) return;
        const std::string sender(cells[kFrom]);
        auto known = std::find(senders.begin(), senders.end(), sender);
        if (known == senders.end()) known = senders.insert(senders.end(), sender);
        const auto fault = cosim::fault_of_name(cells[kFault]);
        times.push_back(time);
        from.push_back(static_cast<std::size_t>(known - senders.begin()));
        values.push_back(value);
        kinds.push_back(fault && keeps_from_arriving(*fault) ? 1
                        : fault == cosim::FaultKind::Insert  ? 2
                        : is_break                           ? 3
                                                             : 0);
    }
};

}  // namespace

std::string serial_bytes(const std::filesystem::path& trace, std::string_view link, std::size_t from) {
    std::ifstream in(trace, std::ios::binary);
    std::string text(kMostSerialScan, '\0');
    if (!in || !in.seekg(static_cast<std::streamoff>(from))) text.clear();
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    const bool full = !text.empty() && static_cast<std::size_t>(in.gcount()) == text.size();
    text.resize(std::min(text.size(), static_cast<std::size_t>(in.gcount())));
    const std::size_t end = text.rfind('\n');  // of the last whole row
    text.resize(end == std::string::npos ? 0 : end + 1);
    SerialRows rows;
    const std::string begin = std::string(link) + ",";
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t stop = text.find('\n', at);
        const std::string_view line = std::string_view(text).substr(at, stop - at);
        // Most rows are of other links: not worth being cut into cells.
        const std::size_t comma = line.find(',');
        if (comma != std::string_view::npos && line.substr(comma + 1).starts_with(begin))
            rows.take(line, link);
        at = stop + 1;
    }
    const ordered_json answer{{"next", from + text.size()},
                              {"more", full && !text.empty()},
                              {"from", rows.senders},
                              {"t", rows.times},
                              {"f", rows.from},
                              {"v", rows.values},
                              {"k", rows.kinds}};
    return answer.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace puckloop::view
