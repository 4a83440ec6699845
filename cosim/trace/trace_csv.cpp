#include "cosim/trace/trace_csv.h"

#include "base/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace puckloop::cosim {

TraceCsvSink::TraceCsvSink(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "we")) {
    if (!file_) throw RunError(fmt::format("{}: cannot write: {}", path_, std::strerror(errno)));
}

TraceCsvSink::~TraceCsvSink() {
    std::fclose(file_);
}

void TraceCsvSink::fail() {
    const int cause = errno;
    failed_ = true;
    throw RunError(
        fmt::format("{}: cannot write: {}; what was written before is kept", path_, std::strerror(cause)));
}

void TraceCsvSink::put(const std::string& line) {
    if (failed_) return;
    if (std::fwrite(line.data(), 1, line.size(), file_) != line.size()) fail();
}

void TraceCsvSink::begin(const std::vector<LinkSpec>& links) {
    links_ = links;
    put(std::string(kTraceColumns) + "\n");
}

void TraceCsvSink::record(const TraceRecord& record) {
    const LinkSpec& link = links_[record.link];
    const bool wanted = record.direction == Direction::FromA ? link.record_from_a : link.record_from_b;
    if (wanted) put(to_csv(to_row(record, links_)) + "\n");
}

void TraceCsvSink::flush() {
    if (!failed_ && std::fflush(file_) != 0) fail();
}

TraceRow to_row(const TraceRecord& record, const std::vector<LinkSpec>& links) {
    const LinkSpec& link = links[record.link];
    TraceRow row{record.time, link.name,    record.direction == Direction::FromA ? link.a.node : link.b.node,
                 {},          record.fault, record.payload};
    if (const auto* signal = std::get_if<Signal>(&record.payload))
        if (signal->id < link.signal_names.size()) row.signal = link.signal_names[signal->id];
    return row;
}

bool read_trace(std::istream& in, const std::string& name, const std::function<void(const TraceRow&)>& take) {
    std::string line;
    if (!std::getline(in, line) || line != kTraceColumns)
        throw InputError(name, "line 1", "no recorded trace", std::string(kTraceColumns));
    for (std::size_t number = 2; std::getline(in, line); ++number) {
        if (in.eof()) return false;
        take(parse_trace_row(line, name, number));
    }
    return true;
}

}  // namespace puckloop::cosim
