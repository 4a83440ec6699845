// `--board rab`: the range-and-bearing board, alone: what its receivers see is the stimulus's, and its bus
// master the `--i2c` script.

#include "base/json.h"
#include "base/states/archive.h"
#include "bench/targets/dspic_target.h"
#include "emu/rab_board/board.h"
#include "emu/rab_board/rab_json.h"
#include "emu/rab_board/rab_log.h"
#include "protocols/serial/uart_sampling.h"

#include <optional>

namespace puckloop::exec {

namespace {

class RabTarget : public DspicTarget, private rab::BoardListener {
  public:
    RabTarget(const rab::BoardParameters& parameters, const TargetOptions& options, TargetListener& listener)
        : DspicTarget(dspic::dspic33fj256gp710(), options, listener),
          listener_(listener),
          log_file_(options.log),
          board_(parameters, *this),
          tap_(board_, listener, rab::pin_function) {
        build(tap_);
        board_.connect(chip());
    }

    void load(const image::Image& image) override {
        log_.emplace(log_file_, image);
        DspicTarget::load(image);
    }
    void repeat(bool on) override { repeats_ = on; }
    void run_until(cosim::Time until) override {
        while (!repeats_ && log_->next_look() <= until) {
            const cosim::Time look = log_->next_look();
            DspicTarget::run_until(look);
            if (chip().stopped_at()) return;
            log_->look(chip());
        }
        DspicTarget::run_until(until);
    }
    void uart_receive(int unit, const cosim::UartFrame& frame) override {
        if (!repeats_) log_->arrived(unit, frame, chip().now(), chip().uart_enabled(unit));
        DspicTarget::uart_receive(unit, frame);
    }
    void i2c_slave_phase(const cosim::I2cPhase& phase) override {
        if (!repeats_) log_->i2c_phase(phase, chip().now());
        DspicTarget::i2c_slave_phase(phase);
    }
    std::string report() const override { return rab::activity_json(board_, *log_).dump(); }
    void finish() override {
        log_->end(chip().now(), chip());
        DspicTarget::finish();
    }

  private:
    std::span<const cosim::SignalInfo> own_signals() const override { return rab::signals(); }
    double own_signal(std::uint16_t id) const override { return board_.signal(id); }
    void set_own_signal(std::uint16_t id, double value) override {
        if (const auto port = board_.set_signal(id, value, chip().now())) chip().pins_changed(*port);
        if (rab::Board::is_supply(id)) chip().supply_changed();
    }
    void save_own(StateWriter& archive) override { archive(board_); }
    void restore_own(StateReader& archive) override { archive(board_); }
    void passed(dspic::Cycle) override { board_.settle(chip().now()); }
    void signal_changed(rab::SignalId id, double value, cosim::Time now) override {
        if (repeats_) return;
        log_->signal_changed(id, value, now);
        // The rest are pins of their own.
        if (id <= rab::kPower) listener_.signal_changed(rab::signals()[id].name, value, now);
    }
    void emitters_changed(std::uint16_t on, cosim::Time now) override {
        if (!repeats_) log_->emitters(on, now);
    }
    void uart_sent(int unit, const cosim::UartFrame& frame) override {
        if (!repeats_) log_->sent(unit, frame, protocols::stop_bit_start(frame));
    }
    void i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) override {
        if (!repeats_) log_->i2c_answer(answer, now);
    }
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override { on_bus(unit, phase); }

    TargetListener& listener_;
    std::string log_file_;
    std::optional<rab::RabLog> log_;
    bool repeats_ = false;  ///< the log knows all this
    rab::Board board_;
    PinTap tap_;
};

}  // namespace

std::unique_ptr<Target> make_rab_target(const TargetOptions& options, TargetListener& listener) {
    return std::make_unique<RabTarget>(board_parameters<rab::BoardParameters>(options), options, listener);
}

}  // namespace puckloop::exec
