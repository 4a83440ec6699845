#pragma once
// The I2C bus of a target that is its master, with devices on it: the bus and the devices of a run
// (cosim/i2c/i2c_bus.h), advanced beside the target with the conductor's own bounds.

#include "bench/bus/i2c_device_spec.h"
#include "cosim/core/node.h"
#include "cosim/core/signal_info.h"
#include "cosim/schedule/bounds.h"

#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace puckloop::exec {

class DeviceBus {
  public:
    struct Options {
        std::uint64_t seed = 1;
        double adc_noise_counts = 0.0;  ///< of a board with a converter
        std::string rab_log{};          ///< file for the range-and-bearing board's log; empty: none
    };
    /// A device's output signal changed.
    using Emit = std::function<void(std::string_view name, double value, cosim::Time time)>;

    /// Throws InputError for an image that cannot be read or does not fit.
    DeviceBus(const std::vector<I2cDeviceSpec>& devices, const Options& options, Emit emit);

    /// Of all devices; an id indexes it.
    std::span<const cosim::SignalInfo> signals() const { return signals_; }
    double signal(std::size_t id) const { return values_[id]; }
    void set_signal(std::size_t id, double value, cosim::Time now);

    /// The target begins a phase.
    void phase(const cosim::I2cPhase& phase);
    /// Brings the devices on. The target has run everything before `now` and begins no phase before
    /// `earliest` on its own. Returns how far, at most to `until`, it may be run before this is to be called
    /// again.
    cosim::Time advance(cosim::Time now, cosim::Time earliest, cosim::Time until);
    /// When the next answer to the target is due; kNever while there is none.
    cosim::Time due() const;
    cosim::I2cPhase take();

    /// The run is over; returns the bus's and the boards' report as JSON text.
    std::string finish();

  private:
    struct Part {
        std::unique_ptr<cosim::Node> node;
        std::vector<cosim::Message> inbox{};
        cosim::Time reached = 0;
    };
    struct SignalPlace {
        std::size_t part;
        cosim::PortIndex port;
        std::uint16_t id;
    };
    void add_board(const I2cDeviceSpec& spec, const Options& options);
    void add_signals(std::span<const cosim::SignalInfo> signals, std::size_t part, cosim::PortIndex port,
                     std::uint16_t first, std::uint16_t count);
    void deliver(std::size_t part, cosim::Message message);
    void set_channels(cosim::Time now, cosim::Time earliest);
    bool advance_part(std::size_t part, cosim::Time until);
    void route(std::size_t from, const cosim::Message& message);
    bool is_world(cosim::PortIndex port) const { return port == parts_.size(); }

    Emit emit_;
    std::vector<Part> parts_;  ///< the bus, then the boards on it
    std::vector<cosim::SignalInfo> signals_;
    std::vector<double> values_;
    std::vector<SignalPlace> places_;
    std::deque<cosim::Message> answers_;  ///< to the target
    cosim::Bounds bounds_;
    std::vector<cosim::Channel> channels_;
    std::vector<cosim::Time> pending_;
};

}  // namespace puckloop::exec
