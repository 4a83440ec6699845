#include "bench/wav_file.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

namespace puckloop::exec {

namespace {

constexpr double kSampleFullScale = 32768.0;
constexpr std::uint32_t kSampleBytes = 2, kHeaderBytes = 44, kFormatBytes = 16;
constexpr std::uint32_t kRateOfOne = 8000;  // where a single sample came

void put(std::string& bytes, std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i)
        bytes += static_cast<char>(value >> (8 * i) & 0xFFu);
}

std::string header(std::uint32_t rate, std::uint32_t data_bytes) {
    constexpr int kShort = 2, kLong = 4;
    constexpr std::uint32_t kPcm = 1, kChannels = 1;
    std::string bytes = "RIFF";
    put(bytes, data_bytes + kHeaderBytes - 8, kLong);
    bytes += "WAVEfmt ";
    put(bytes, kFormatBytes, kLong);
    put(bytes, kPcm, kShort);
    put(bytes, kChannels, kShort);
    put(bytes, rate, kLong);
    put(bytes, rate * kSampleBytes, kLong);
    put(bytes, kSampleBytes, kShort);
    put(bytes, 8 * kSampleBytes, kShort);
    bytes += "data";
    put(bytes, data_bytes, kLong);
    return bytes;
}

}  // namespace

std::uint32_t WavFile::rate() const {
    return period_ > 0 ? static_cast<std::uint32_t>(std::lround(1.0 / cosim::to_seconds(period_))) : 0;
}

void WavFile::append(double value, cosim::Time time) {
    const auto place = static_cast<std::size_t>((time + period_ / 2) / period_);
    if (place >= kMostSamples) return;
    if (place >= samples_.size()) samples_.resize(place + 1, 0);
    const double code =
        std::clamp(std::round(value * kSampleFullScale), -kSampleFullScale, kSampleFullScale - 1.0);
    samples_[place] = static_cast<std::int16_t>(code);
}

void WavFile::sample(double value, cosim::Time time) {
    if (++seen_ == 1) {
        first_ = time;
        first_value_ = value;
        return;
    }
    if (seen_ == 2) {
        period_ = std::max<cosim::Time>(time - first_, 1);
        append(first_value_, first_);
    }
    append(value, time);
}

void WavFile::close() {
    if (seen_ == 0) return;
    if (seen_ == 1) {
        period_ = cosim::from_seconds(1.0 / kRateOfOne);
        append(first_value_, first_);
    }
    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    const std::unique_ptr<std::FILE, Closer> file(new_file(path_));
    const auto bytes = static_cast<std::uint32_t>(samples_.size() * kSampleBytes);
    const std::string head = header(rate(), bytes);
    const bool written = file && std::fwrite(head.data(), 1, head.size(), file.get()) == head.size() &&
                         std::fwrite(samples_.data(), 1, bytes, file.get()) == bytes &&
                         std::fflush(file.get()) == 0;
    if (!written) throw RunError(fmt::format("{}: cannot be written: {}", path_, why_not_written(errno)));
}

}  // namespace puckloop::exec
