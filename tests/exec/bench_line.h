#pragma once
// The control program's serial line, tied to UART2 of an emulated board on the bench: the real session code
// against real firmware, in simulated time. Bytes can be lost or doubled on their way.

#include "linuxboard/control/devices/transport.h"
#include "tests/exec/rig.h"

#include <deque>
#include <map>

namespace puckloop::exec {

class BenchLine : public control::Transport {
  public:
    explicit BenchLine(Rig& rig) : rig_(rig) {}

    /// Rounded up, so that a wait always ends.
    double now() override { return rig_.now_s() + kRounding; }
    void sleep_until(double time) override {
        while (time - rig_.now_s() > kRounding) {
            if (!restarts.empty() && rig_.now_s() >= restarts.front()) {
                restarts.pop_front();
                rig_.chip().mclr();
            }
            rig_.run_to(std::min(time, rig_.now_s() + kGrain));
        }
    }
    std::size_t read(std::span<std::uint8_t> into, double until) override {
        collect();
        while (received_.empty() && until - rig_.now_s() > kRounding) {
            sleep_until(std::min(until, rig_.now_s() + kGrain));
            collect();
        }
        std::size_t count = 0;
        for (; count < into.size() && !received_.empty(); ++count) {
            into[count] = received_.front();
            received_.pop_front();
        }
        return count;
    }
    void write(std::span<const std::uint8_t> bytes) override {
        std::vector<std::uint8_t> arriving;
        for (const std::uint8_t byte : bytes) {
            const auto found = copies.find(sent++);
            arriving.insert(arriving.end(), found == copies.end() ? 1U : found->second, byte);
        }
        rig_.send(2, arriving);
    }

    unsigned long sent = 0;                    ///< bytes written so far
    std::map<unsigned long, unsigned> copies;  ///< by ordinal number of the byte: how often it arrives
    std::deque<double> restarts;               ///< times of pulses on MCLR

  private:
    static constexpr double kGrain = 0.0002;
    static constexpr double kRounding = 1e-9;  // picoseconds against doubles
    void collect() {
        for (const std::uint8_t byte : rig_.take_bytes(2))
            received_.push_back(byte);
    }

    Rig& rig_;
    std::deque<std::uint8_t> received_;
};

}  // namespace puckloop::exec
