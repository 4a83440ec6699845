#include "traces/recorded_trace.h"

#include "base/error.h"
#include "base/new_file.h"
#include "base/partial_file.h"

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
    if (selection_.until_s <= selection_.from_s)
        throw InputError("", "--to", fmt::format("{} s is not after --from", selection_.until_s),
                         fmt::format("more than {} s", selection_.from_s));
}

RecordedTrace::Cursor::Cursor(const RecordedTrace& trace)
    : trace_(trace), in_(trace.file_, std::ios::binary), buffer_(kLongestLine) {
    const std::string file = trace.file_.string();
    if (!in_) throw InputError(file, "", std::strerror(errno), "a trace.csv that a run recorded");
    if (!read_line() || line_ != cosim::kTraceColumns)
        throw InputError(file, "line 1", "no recorded trace", std::string(cosim::kTraceColumns));
}

bool RecordedTrace::Cursor::read_line() {
    in_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    const auto count = static_cast<std::size_t>(in_.gcount());
    ++number_;
    if (in_.fail() && count + 1 == buffer_.size())
        throw InputError(trace_.file_.string(), fmt::format("line {}", number_),
                         fmt::format("longer than {} characters", count),
                         number_ == 1 ? std::string(cosim::kTraceColumns) : "a row of a recorded trace");
    if (!in_) return false;
    line_ = std::string_view(buffer_.data(), in_.eof() ? count : count - 1);
    return true;
}

std::optional<cosim::TraceRow> RecordedTrace::Cursor::next_of_all() {
    if (!whole_ || !read_line()) return std::nullopt;
    if (in_.eof()) {
        whole_ = false;
        return std::nullopt;
    }
    return cosim::parse_trace_row(line_, trace_.file_.string(), number_);
}

std::optional<cosim::TraceRow> RecordedTrace::Cursor::next() {
    while (auto row = next_of_all())
        if (trace_.selection_.wanted(*row)) return row;
    return std::nullopt;
}

void RecordedTrace::for_each_checked(const std::function<void(const cosim::TraceRow&)>& take) const {
    std::set<std::string> links, nodes;
    Cursor cursor(*this);
    while (const auto row = cursor.next_of_all()) {
        links.insert(row->link);
        nodes.insert(row->from);
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
