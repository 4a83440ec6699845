#pragma once
// The bench's recordings: uart1.csv, uart2.csv, i2c.csv and pins.csv in one folder. Times are seconds of
// simulated time with nine decimals.

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace puckloop::exec {

/// One file. Throws RunError, naming the file, as soon as a row cannot be written.
class CsvFile {
  public:
    CsvFile(const std::string& path, std::string_view header);
    void row(std::string_view text);
    void flush();

  private:
    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    [[noreturn]] void fail() const;
    std::string path_;
    std::unique_ptr<std::FILE, Closer> file_;
};

class Logs {
  public:
    /// Creates `folder` if it does not exist; throws InputError if it cannot.
    explicit Logs(const std::string& folder);

    /// uartN.csv: `time_s,direction,byte,error`; time is that of the start bit (of an error: when it was
    /// seen). Direction "tx" is from the chip, "rx" to it.
    void uart(int unit, cosim::Time time, std::string_view direction, int byte, std::string_view error);
    /// i2c.csv: `time_s,module,event,byte,ack,clock_hz,stretch_s`.
    void i2c(int unit, const cosim::I2cPhase& phase);
    /// pins.csv: `time_s,pin,signal,value`. `pin` is empty for signals that are no pin (a wheel, a stimulus).
    void pin(cosim::Time time, std::string_view pin, std::string_view signal, std::string_view value);
    void flush();

  private:
    std::array<CsvFile, 2> uart_;
    CsvFile i2c_;
    CsvFile pins_;
};

}  // namespace puckloop::exec
