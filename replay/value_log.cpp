#include "replay/value_log.h"

#include "base/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace puckloop::tools {

namespace {

[[noreturn]] void fail() {
    throw RunError(fmt::format("a temporary file for the values: {}", std::strerror(errno)));
}

}  // namespace

ValueLog::ValueLog() : file_(std::tmpfile()) {
    if (!file_) fail();
}

void ValueLog::add(const ValueChange& change) {
    if (std::fwrite(&change, sizeof change, 1, file_.get()) != 1) fail();
    ++size_;
}

void ValueLog::rewind() {
    if (std::fflush(file_.get()) != 0) fail();
    std::rewind(file_.get());
}

std::optional<ValueChange> ValueLog::next() {
    ValueChange change;
    if (std::fread(&change, sizeof change, 1, file_.get()) != 1) return std::nullopt;
    return change;
}

}  // namespace puckloop::tools
