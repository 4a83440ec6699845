#pragma once
// A target with a past: what came in from outside is written down, the state is saved now and then, and any
// moment so far can be had again by loading a state and repeating what came in. What the target does while it
// repeats itself goes nowhere: the world outside has seen it already.

#include "bench/targets/target.h"
#include "debug/debug_chip.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace puckloop::exec {

class History final : public Target, private TargetListener {
  public:
    using MakeTarget = std::function<std::unique_ptr<Target>(TargetListener& listener)>;
    History(const MakeTarget& make, TargetListener& listener);

    /// The past begins now. The chip is looked at through `chip`, which must stay.
    void begin(debug::DebugChip& chip);
    /// Saves the state if it is time to. Present only.
    void note();
    /// The target stands before the present.
    bool in_past() const { return past_; }
    /// The latest saved state that lies before this cycle; nothing: none does.
    std::optional<std::size_t> state_before(std::uint64_t cycle) const;
    /// Back to a saved state.
    void restore(std::size_t state);
    /// Repeats, at most up to `slice` of simulated time, and not beyond the present; true: the chip stopped.
    bool repeat_for(cosim::Time slice);
    /// Does something to the target now, and again whenever this moment comes again. Present only.
    void apply(std::function<void(Target&)> act);

    std::span<const cosim::SignalInfo> signals() const override { return inner_->signals(); }
    void set_signal(std::uint16_t id, double value) override;
    double signal(std::uint16_t id) const override { return inner_->signal(id); }
    void load(const image::Image& image) override { inner_->load(image); }
    void run_until(cosim::Time until) override { inner_->run_until(until); }
    void uart_receive(int unit, const cosim::UartFrame& frame) override;
    bool is_i2c_slave() const override { return inner_->is_i2c_slave(); }
    void i2c_slave_phase(const cosim::I2cPhase& phase) override;
    cosim::Time earliest_i2c_answer() const override { return inner_->earliest_i2c_answer(); }
    std::string report() const override { return inner_->report(); }
    std::string i2c_devices_report() const override { return inner_->i2c_devices_report(); }
    void finish() override { inner_->finish(); }
    dspic::Chip& chip() override { return inner_->chip(); }
    const cosim::ClockDomain& clock() override { return inner_->clock(); }
    cosim::Time now() override { return inner_->now(); }
    std::uint32_t pc() override { return inner_->pc(); }
    void stop_at(std::uint32_t pc) override { inner_->stop_at(pc); }
    bool stopped() override { return inner_->stopped(); }
    bool uart_enabled(int unit) override { return inner_->uart_enabled(unit); }
    dspic::UartCounters uart_counters(int unit) override { return inner_->uart_counters(unit); }
    std::size_t resets() override { return inner_->resets(); }
    image::Image read_image(const std::string& file, std::string_view mcu) override {
        return inner_->read_image(file, mcu);
    }
    std::string chip_json() override { return inner_->chip_json(); }
    std::string chip_text() override { return inner_->chip_text(); }
    std::vector<std::string> warnings() override { return inner_->warnings(); }
    std::optional<std::string> hang() override { return inner_->hang(); }
    std::string source_line(std::uint32_t pc) const override { return inner_->source_line(pc); }
    std::vector<std::uint32_t> addresses_of(std::string_view file, std::uint32_t line) const override {
        return inner_->addresses_of(file, line);
    }
    const image::LineTable& lines() const override { return inner_->lines(); }
    void reset_button() override;
    void load_kept(const image::Image& image, const board::NvmFile& nvm) override {
        inner_->load_kept(image, nvm);
    }
    void save_memory(board::NvmFile& nvm) override { inner_->save_memory(nvm); }
    std::unique_ptr<debug::DebugChip> debug_chip() override { return inner_->debug_chip(); }
    bool saves() const override { return inner_->saves(); }

  private:
    void uart_sent(int unit, const cosim::UartFrame& frame) override;
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override;
    void i2c_answered(const cosim::I2cPhase& answer, cosim::Time time) override;
    void pin_changed(std::string_view pin, std::string_view function, std::optional<bool> level,
                     cosim::Time time) override;
    void signal_changed(std::string_view name, double value, cosim::Time time) override;
    void sound_sample(double value, cosim::Time time) override;
    void take();

    struct Act {
        cosim::Time time = 0;
        std::function<void(Target&)> act;
    };
    struct Saved {
        cosim::Time time = 0;
        std::uint64_t cycle = 0;
        std::size_t next_act = 0;
        std::vector<std::uint8_t> bytes;
    };
    static constexpr std::size_t kMostStates = 64;

    TargetListener& listener_;
    std::unique_ptr<Target> inner_;
    debug::DebugChip* debug_chip_ = nullptr;
    std::vector<Act> acts_;
    std::vector<Saved> states_;
    cosim::Time interval_ = 5 * cosim::kMillisecond;  ///< between states; grows as they are thinned out
    bool past_ = false;
    std::size_t next_act_ = 0;  ///< while in the past
    cosim::Time present_ = 0;   ///< while in the past
};

}  // namespace puckloop::exec
