#include "bench/logs.h"

#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace puckloop::exec {

namespace {

std::string prepared(const std::string& folder) {
    claim_folder(folder, ".puckloop-exec", {"uart1.csv", "uart2.csv", "i2c.csv", "pins.csv"});
    return folder + "/";
}

std::string_view name_of(cosim::I2cPhaseKind kind) {
    switch (kind) {
    case cosim::I2cPhaseKind::Start:
        return "start";
    case cosim::I2cPhaseKind::Write:
        return "write";
    case cosim::I2cPhaseKind::Read:
        return "read";
    case cosim::I2cPhaseKind::Stop:
        return "stop";
    case cosim::I2cPhaseKind::Acknowledge:
        return "acknowledge";
    case cosim::I2cPhaseKind::Data:
        return "data";
    case cosim::I2cPhaseKind::BusLost:
        return "bus lost";
    }
    return "";
}

}  // namespace

CsvFile::CsvFile(const std::string& path, std::string_view header) : path_(path), file_(new_file(path)) {
    if (!file_) throw InputError(path_, "", fmt::format("cannot be created: {}", why_not_written(errno)));
    row(header);
}

void CsvFile::row(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() ||
        std::fputc('\n', file_.get()) == EOF)
        fail();
}

void CsvFile::flush() {
    if (std::fflush(file_.get()) != 0) fail();
}

void CsvFile::fail() const {
    throw RunError(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
}

Logs::Logs(const std::string& folder)
    : uart_{CsvFile{prepared(folder) + "uart1.csv", "time_s,direction,byte,error"},
            CsvFile{folder + "/uart2.csv", "time_s,direction,byte,error"}},
      i2c_(folder + "/i2c.csv", "time_s,module,event,byte,ack,clock_hz,stretch_s"),
      pins_(folder + "/pins.csv", "time_s,pin,signal,value") {}

void Logs::uart(int unit, cosim::Time time, std::string_view direction, int byte, std::string_view error) {
    const std::string value = byte < 0 ? std::string() : fmt::format("{:02x}", byte);
    uart_[static_cast<std::size_t>(unit - 1)].row(
        fmt::format("{:.9f},{},{},{}", cosim::to_seconds(time), direction, value, error));
}

void Logs::i2c(int unit, const cosim::I2cPhase& phase) {
    const double hertz = phase.clock_period > 0 ? 1.0 / cosim::to_seconds(phase.clock_period) : 0.0;
    i2c_.row(fmt::format("{:.9f},{},{},{:02x},{},{:.0f},{:.9f}", cosim::to_seconds(phase.start), unit,
                         name_of(phase.kind), phase.byte, phase.ack, hertz,
                         cosim::to_seconds(phase.stretch)));
}

void Logs::pin(cosim::Time time, std::string_view pin, std::string_view signal, std::string_view value) {
    pins_.row(fmt::format("{:.9f},{},{},{}", cosim::to_seconds(time), pin, signal, value));
}

void Logs::flush() {
    for (CsvFile& file : uart_)
        file.flush();
    i2c_.flush();
    pins_.flush();
}

}  // namespace puckloop::exec
