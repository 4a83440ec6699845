// `--board tam`: the TAM, alone: who stands in it, its battery and its switches are the stimulus's. uart1 is
// the debug console, uart2 the socket of the radio module.

#include "base/json.h"
#include "base/states/archive.h"
#include "bench/targets/avr_target.h"
#include "emu/tam_avr/board.h"
#include "emu/tam_avr/fuse_check.h"

namespace puckloop::exec {

namespace {

class TamTarget final : public AvrTarget, private tam::BoardListener {
  public:
    TamTarget(const TargetOptions& options, TargetListener& listener)
        : AvrTarget(avr::atmega1284p(), options.fuses, listener), board_(parameters(options), *this) {
        board_.chip().set_skipping(options.skip_idle);
    }

    std::span<const cosim::SignalInfo> signals() const override { return tam::signals(); }
    double signal(std::uint16_t id) const override { return board_.signal(id); }
    void set_signal(std::uint16_t id, double value) override { board_.set_signal(id, value); }

    void load(const image::Image&) override { board_.load(firmware()); }
    void run_until(cosim::Time until) override { board_.run_until(until); }
    cosim::Time now() override { return board_.now(); }
    void uart_receive(int unit, const cosim::UartFrame& frame) override {
        board_.uart_receive(unit - 1, frame);
    }
    void reset_button() override { board_.reset_button(); }
    bool saves() const override { return true; }
    void save_state(StateWriter& archive) override { archive(board_); }
    void restore_state(StateReader& archive) override { archive(board_); }
    std::vector<std::string> warnings() override {
        std::vector<std::string> lines = AvrTarget::warnings();
        for (std::string& line : tam::fuse_warnings(board_.chip().fuses(), firmware()))
            lines.push_back(std::move(line));
        return lines;
    }
    std::string report() const override {
        nlohmann::ordered_json json;
        json["powered"] = board_.powered();
        json["led_registers_written"] = board_.leds().registers_written();
        return json.dump();
    }

  private:
    static tam::BoardParameters parameters(const TargetOptions& options) {
        tam::BoardParameters parameters;
        parameters.seed = options.seed;
        parameters.resonator_hertz = options.chip.crystal_hertz;
        parameters.resonator_ppm = options.chip.ppm;
        parameters.adc_noise_counts = options.adc_noise_counts;
        return parameters;
    }
    avr::Chip& avr() override { return board_.chip(); }

    void signal_changed(tam::SignalId id, double value, cosim::Time now) override {
        // The other outputs are pins of their own.
        if (id >= tam::kLed) listener().signal_changed(tam::signals()[id].name, value, now);
    }
    void uart_sent(int unit, const cosim::UartFrame& frame) override {
        listener().uart_sent(unit + 1, frame);
    }
    void pins_driven(avr::PortLetter port, std::uint8_t levels, std::uint8_t driven,
                     cosim::Time now) override {
        show_pins(port, levels, driven, now, tam::pin_function);
    }
    void twi_phase(const cosim::I2cPhase& phase) override { listener().i2c_phase(kI2cDeviceUnit, phase); }

    tam::Board board_;
};

}  // namespace

std::unique_ptr<Target> make_tam_target(const TargetOptions& options, TargetListener& listener) {
    return std::make_unique<TamTarget>(options, listener);
}

}  // namespace puckloop::exec
