#include "cosim/trace/trace_stats.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

namespace {

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        if (c >= ' ') result += c;
    }
    return result + "\"";
}

}  // namespace

void TraceStats::add(const TraceRow& row) {
    if (messages_++ == 0) first_ = row.time;
    last_ = row.time;
    const auto [found, is_new] = entries_.try_emplace({row.link, row.from});
    Entry& entry = found->second;
    if (is_new) entry.first = row.time;
    entry.last = row.time;
    TraceRecord record;
    record.time = row.time;
    record.fault = row.fault;
    record.payload = row.payload;
    // A file does not hold the nominal rate: what the links counted of it stands in the run's report.
    entry.stats.count(record, 0.0);
    entry.stats.uart_off_rate = 0;
}

std::string TraceStats::text() const {
    std::size_t link_width = 4, from_width = 4;
    for (const auto& [key, entry] : entries_) {
        link_width = std::max(link_width, key.first.size());
        from_width = std::max(from_width, key.second.size());
    }
    std::string text =
        fmt::format("{:<{}}  {:<{}}  {:>9} {:>8} {:>8} {:>7} {:>8} {:>7} {:>7} {:>14} {:>14}\n", "link",
                    link_width, "from", from_width, "messages", "bytes", "breaks", "parity", "i2c", "nacks",
                    "faults", "first_s", "last_s");
    for (const auto& [key, entry] : entries_) {
        const LinkStats& s = entry.stats;
        text += fmt::format("{:<{}}  {:<{}}  {:>9} {:>8} {:>8} {:>7} {:>8} {:>7} {:>7} {:>14.9f} {:>14.9f}\n",
                            key.first, link_width, key.second, from_width, s.messages,
                            s.uart_frames - s.uart_breaks + s.i2c_bytes + s.radio_octets + s.packet_octets,
                            s.uart_breaks, s.uart_parity_errors, s.i2c_transactions, s.i2c_nacks, s.faults,
                            to_seconds(entry.first), to_seconds(entry.last));
    }
    return text;
}

std::string TraceStats::json() const {
    std::string text = fmt::format("{{\"first_s\": {}, \"last_s\": {}, \"messages\": {}, \"links\": [",
                                   format_seconds(first_), format_seconds(last_), messages_);
    bool first = true;
    for (const auto& [key, entry] : entries_) {
        text += fmt::format(
            "{}\n  {{\"link\": {}, \"from\": {}, \"first_s\": {}, \"last_s\": {}, \"counts\": {}}}",
            first ? "" : ",", quoted(key.first), quoted(key.second), format_seconds(entry.first),
            format_seconds(entry.last), to_json(entry.stats));
        first = false;
    }
    return text + "\n]}\n";
}

}  // namespace puckloop::cosim
