#pragma once
// Sound as a WAV file: one channel of 16 bits at the rate at which its samples came.

#include "cosim/core/time.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::exec {

class WavFile {
  public:
    /// Nothing is written before close(), and no file without a sample.
    explicit WavFile(std::string path) : path_(std::move(path)) {}

    /// `value` -1..1, clipped; times rise. The first two say how long a sample takes. Where none came for
    /// longer, and before the first one, there is silence: second 0 of the file is second 0 of the run.
    void sample(double value, cosim::Time time);
    /// Throws RunError, naming the file.
    void close();

    /// Samples a second; 0 as long as fewer than two came.
    std::uint32_t rate() const;

  private:
    /// An hour and more at a codec's rate; what comes later is left out.
    static constexpr std::size_t kMostSamples = 64u << 20;
    void append(double value, cosim::Time time);

    std::string path_;
    cosim::Time first_ = 0;
    cosim::Time period_ = 0;
    double first_value_ = 0.0;
    std::size_t seen_ = 0;
    std::vector<std::int16_t> samples_;
};

}  // namespace puckloop::exec
