#include "traces/recorded_trace.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/files/partial_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <set>

namespace puckloop::tools {

namespace {

// A row of a radio frame has some 400.
constexpr std::size_t kLongestLine = 4096;
constexpr std::size_t kPiece = 64 * kLongestLine;  // read at once

void check_known(const char* option, const std::vector<std::string>& asked,
                 const std::set<std::string>& known) {
    for (const std::string& name : asked)
        if (!known.contains(name))
            throw InputError("", option, fmt::format("'{}' does not occur in the trace", name),
                             fmt::format("one of {}", fmt::join(known, ", ")));
}

}  // namespace

std::string_view kind_of(const cosim::TraceRow& row) {
    constexpr std::string_view kKinds[] = {"uart", "i2c", "signal", "radio", "can", "packet"};
    return kKinds[row.payload.index()];
}

bool TraceSelection::wanted(const cosim::TraceRow& row) const {
    const auto among = [](const std::vector<std::string>& list, std::string_view name) {
        return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
    };
    return row.time >= cosim::from_seconds(from_s) && row.time < cosim::from_seconds(until_s) &&
           among(links, row.link) && (nodes_only_named || among(nodes, row.from)) &&
           among(kinds, kind_of(row));
}

RecordedTrace::RecordedTrace(const std::filesystem::path& place, TraceSelection selection)
    : file_(place), selection_(std::move(selection)) {
    std::error_code error;
    if (std::filesystem::is_directory(file_, error)) file_ /= "trace.csv";
    const auto status = std::filesystem::status(file_, error);
    if (!std::filesystem::exists(status))
        throw InputError(file_.string(), "", "no such file",
                         "a trace.csv that a run recorded, or its folder");
    if (!std::filesystem::is_regular_file(status))
        throw InputError(file_.string(), "", "is no regular file, and is read more than once",
                         "a trace.csv that a run recorded, or its folder");
    size_ = std::filesystem::file_size(file_, error);
    if (error) size_ = 0;
    if (selection_.until_s <= selection_.from_s)
        throw InputError("", "--to", fmt::format("{} s is not after --from", selection_.until_s),
                         fmt::format("more than {} s", selection_.from_s));
}

RecordedTrace RecordedTrace::with(TraceSelection selection) const {
    RecordedTrace other = *this;
    other.selection_ = std::move(selection);
    return other;
}

RecordedTrace::Cursor::Cursor(const RecordedTrace& trace)
    : trace_(trace), in_(trace.file_, std::ios::binary), left_(trace.size_), buffer_(kPiece) {
    const std::string file = trace.file_.string();
    if (!in_) throw InputError(file, "", std::strerror(errno), "a trace.csv that a run recorded");
    if (!read_line() || line_ != cosim::kTraceColumns)
        throw InputError(file, "line 1", "no recorded trace", std::string(cosim::kTraceColumns));
}

void RecordedTrace::Cursor::refuse_long() const {
    throw InputError(trace_.file_.string(), fmt::format("line {}", number_),
                     fmt::format("longer than {} characters", kLongestLine - 1),
                     number_ == 1 ? std::string(cosim::kTraceColumns) : "a row of a recorded trace");
}

bool RecordedTrace::Cursor::read_line() {
    ++number_;
    for (std::size_t looked = begin_;;) {
        const char* const from = buffer_.data() + begin_;
        const void* const found = std::memchr(buffer_.data() + looked, '\n', end_ - looked);
        line_ended_ = found != nullptr;
        const std::size_t size =
            line_ended_ ? static_cast<std::size_t>(static_cast<const char*>(found) - from) : end_ - begin_;
        if (size >= kLongestLine) refuse_long();
        if (line_ended_ || left_ == 0) {
            line_ = {from, size};
            begin_ = std::min(end_, begin_ + size + 1);
            return line_ended_ || size > 0;
        }
        std::memmove(buffer_.data(), from, size);
        const auto more = std::min<std::uintmax_t>(buffer_.size() - size, left_);
        in_.read(buffer_.data() + size, static_cast<std::streamsize>(more));
        const auto got = static_cast<std::size_t>(in_.gcount());
        left_ = got < more ? 0 : left_ - got;
        begin_ = 0;
        looked = size;
        end_ = size + got;
    }
}

/// By the columns up to the signal's name.
bool RecordedTrace::Cursor::is_passed_over() const {
    constexpr std::string_view kSignal = "signal";
    std::string_view rest = line_;
    for (int column = 0; column < 5; ++column) {
        const std::size_t comma = rest.find(',');
        if (comma == std::string_view::npos) return false;
        if (column == 3 && rest.substr(0, comma) != kSignal) return false;
        rest.remove_prefix(comma + 1);
    }
    return trace_.selection_.passes_over(rest.substr(0, rest.find(',')));
}

std::optional<cosim::TraceRow> RecordedTrace::Cursor::next_of_all() {
    while (whole_ && read_line()) {
        if (!line_ended_) {
            whole_ = false;
            break;
        }
        if (trace_.selection_.passes_over && is_passed_over()) continue;
        return cosim::parse_trace_row(line_, trace_.file_.string(), number_);
    }
    return std::nullopt;
}

std::optional<cosim::TraceRow> RecordedTrace::Cursor::next() {
    while (auto row = next_of_all())
        if (trace_.selection_.wanted(*row)) return row;
    return std::nullopt;
}

void RecordedTrace::for_each_checked(const std::function<void(const cosim::TraceRow&)>& take) const {
    std::set<std::string> links, nodes;
    Cursor cursor(*this);
    const bool named = !selection_.links.empty() || !selection_.nodes.empty();
    while (const auto row = cursor.next_of_all()) {
        if (named) {
            links.insert(row->link);
            nodes.insert(row->from);
        }
        if (selection_.wanted(*row)) take(*row);
    }
    check_known("--link", selection_.links, links);
    check_known("--from-node", selection_.nodes, nodes);
    if (!cursor.whole() && selection_.warns)
        std::fprintf(stderr, "puckloop: %s: the last line is incomplete and left out\n", file_.c_str());
}

void check_output_file(const std::string& path) {
    if (path == "-") return;
    if (is_refused_link(path))
        throw InputError(path, "", why_not_written(ELOOP), "the file itself, or another name");
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    const bool there = ::access(path.c_str(), F_OK) == 0;
    if (::access(there ? path.c_str() : folder.empty() ? "." : folder.c_str(), W_OK) != 0)
        throw InputError(path, "", fmt::format("cannot write: {}", std::strerror(errno)),
                         "a place in a folder that exists and may be written");
}

void write_output(const std::string& path, const std::function<void(std::ostream&)>& write) {
    const auto write_to = [&](std::ostream& out) {
        if (out) write(out);
        out.flush();
        if (!out)
            throw RunError(
                fmt::format("{}: cannot write: {}", path, std::strerror(errno != 0 ? errno : EIO)));
    };
    errno = 0;
    if (path == "-") return write_to(std::cout);
    make_new_file(path);
    std::ofstream file(path, std::ios::binary);
    try {
        write_to(file);
    } catch (...) {
        remove_partial(path);
        throw;
    }
}

}  // namespace puckloop::tools
