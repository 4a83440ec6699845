#pragma once
// A serial line with a simulated clock, a simulated mesh at its other end.

#include "linuxboard/control/devices/transport.h"
#include "tests/coordinator/simulated_mesh.h"

#include <algorithm>

namespace puckloop::coordinator::test {

class VirtualLine : public control::Transport {
  public:
    explicit VirtualLine(SimulatedMesh& mesh) : mesh_(mesh) {}

    double now() override { return now_; }
    void sleep_until(double time) override { now_ = std::max(now_, time); }
    std::size_t read(std::span<std::uint8_t> into, double until) override {
        for (;;) {
            if (waiting_.empty()) waiting_ = mesh_.give(now_);
            if (!waiting_.empty()) break;
            if (now_ >= until) return 0;
            now_ = std::max(now_, std::min(until, mesh_.next()));
        }
        const std::size_t count = std::min(into.size(), waiting_.size());
        std::copy_n(waiting_.begin(), count, into.begin());
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
        return count;
    }
    void write(std::span<const std::uint8_t> bytes) override {
        for (const std::uint8_t byte : bytes) {
            line_free_ = std::max(line_free_, now_) + kByte;
            mesh_.plan(line_free_, [this, byte, at = line_free_] { mesh_.take(byte, at); });
        }
    }

  private:
    SimulatedMesh& mesh_;
    double now_ = 0, line_free_ = 0;
    std::vector<std::uint8_t> waiting_;
};

}  // namespace puckloop::coordinator::test
