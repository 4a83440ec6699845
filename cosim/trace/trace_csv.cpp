#include "cosim/trace/trace_csv.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace puckloop::cosim {

TraceCsvSink::TraceCsvSink(const std::string& path, Rows rows)
    : path_(path), rows_(rows), file_(new_file(path)) {
    if (!file_) throw RunError(fmt::format("{}: cannot write: {}", path_, why_not_written(errno)));
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
    senders_.clear();
    for (const LinkSpec& link : links) {
        senders_.push_back(
            {sender_columns(link.name, link.a.node), link.record_from_a || rows_ == Rows::All, {}});
        senders_.push_back(
            {sender_columns(link.name, link.b.node), link.record_from_b || rows_ == Rows::All, {}});
        for (std::size_t id = 0; id < link.signal_names.size(); ++id)
            for (Sender* one : {&senders_.back() - 1, &senders_.back()})
                one->signals.push_back(signal_column(link.signal_names[id], static_cast<std::uint16_t>(id)));
    }
    if (std::exchange(goes_on_, false)) return;
    put(begin_with_.empty() ? std::string(kTraceColumns) + "\n" : std::exchange(begin_with_, {}));
}

void TraceCsvSink::record(const TraceRecord& record) {
    const Sender& sender = senders_[record.link * 2u + static_cast<unsigned>(record.direction)];
    if (!sender.wanted) return;
    line_.clear();
    const auto* signal = std::get_if<Signal>(&record.payload);
    if (signal == nullptr || signal->id < sender.signals.size())
        append_row(line_, record.time, sender.columns, record.payload,
                   signal == nullptr ? "" : sender.signals[signal->id], record.fault);
    else
        append_row(line_, record.time, sender.columns, record.payload, signal_column("", signal->id),
                   record.fault);
    line_ += '\n';
    put(line_);
}

void TraceCsvSink::flush() {
    if (!failed_ && std::fflush(file_) != 0) fail();
}

std::string TraceCsvSink::written() {
    flush();
    std::ifstream in(path_, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (failed_ || !in) throw RunError(fmt::format("{}: cannot be read again", path_));
    return text;
}

std::uint64_t TraceCsvSink::size() {
    flush();
    const off_t size = ::ftello(file_);
    if (size < 0) fail();
    return static_cast<std::uint64_t>(size);
}

void TraceCsvSink::cut_back(std::uint64_t size) {
    flush();
    const auto end = static_cast<off_t>(size);
    if (::ftruncate(::fileno(file_), end) != 0 || ::fseeko(file_, end, SEEK_SET) != 0) fail();
    goes_on_ = true;
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
