// `--board pic`: the e-puck main board, alone: no Linux board, nobody on its I2C bus but its camera.

#include "base/states/archive.h"
#include "bench/targets/dspic_target.h"
#include "emu/camera/frame_log.h"
#include "emu/camera/pictures.h"
#include "emu/pic/board.h"
#include "emu/pic/pin_table.h"

#include <fmt/format.h>

namespace puckloop::exec {

namespace {

class PicTarget : public DspicTarget, private pic::BoardListener {
  public:
    PicTarget(const pic::BoardParameters& parameters, const TargetOptions& options, TargetListener& listener)
        : DspicTarget(dspic::dspic30f6014a(), options, listener),
          listener_(listener),
          board_(parameters, *this),
          tap_(board_, listener, pic::pin_function),
          camera_log_(options.camera_log) {
        if (const auto model = camera::model_of(options.camera)) {
            scenery_ = options.camera_picture.empty() ? camera::make_test_pattern()
                                                      : camera::make_picture(options.camera_picture);
            board_.fit_camera({*model, options.camera_turned}, *scenery_);
        }
        build(tap_);
    }
    std::string report() const override {
        if (!board_.camera() || board_.camera()->frames().empty()) return {};
        return fmt::format(R"({{"camera": {}}})", camera::report_json(*board_.camera()));
    }
    void finish() override {
        DspicTarget::finish();
        if (board_.camera() && !camera_log_.empty())
            camera::write_frame_log(camera_log_, *board_.camera(), chip().clock());
    }

  private:
    OwnPhase own_i2c(int, const cosim::I2cPhase& phase, dspic::Cycle answered) override {
        const auto own = board_.own_i2c(phase, answered);
        return {own.ours, own.answer};
    }
    void edges_moved(dspic::Cycle at) override { chip().edges_moved(at); }
    std::span<const cosim::SignalInfo> own_signals() const override { return pic::signals(); }
    double own_signal(std::uint16_t id) const override { return board_.signal(id); }
    void set_own_signal(std::uint16_t id, double value) override {
        if (id == pic::kResetButton && value > board_.signal(id)) chip().mclr();
        if (const auto port = board_.set_signal(id, value, chip().cycle())) chip().pins_changed(*port);
        if (id == pic::kBatteryVoltage) chip().supply_changed();
    }
    void save_own(StateWriter& archive) override { archive(board_); }
    void restore_own(StateReader& archive) override { archive(board_); }
    void passed(dspic::Cycle now) override { board_.settle(now); }
    void signal_changed(pic::SignalId id, double value, dspic::Cycle now) override {
        if (id == pic::kWheelLeft || id == pic::kWheelRight)
            listener_.signal_changed(pic::signals()[id].name, value, chip().clock().time_of(now));
    }
    void sound_sample(double value, dspic::Cycle now) override {
        listener_.sound_sample(value, chip().clock().time_of(now));
    }
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override { on_bus(unit, phase); }

    TargetListener& listener_;
    pic::Board board_;
    PinTap tap_;
    std::string camera_log_;
    std::unique_ptr<camera::Scenery> scenery_;
};

}  // namespace

std::unique_ptr<Target> make_pic_target(const TargetOptions& options, TargetListener& listener) {
    auto parameters = board_parameters<pic::BoardParameters>(options);
    parameters.selector = options.selector;
    parameters.revision = options.revision;
    return std::make_unique<PicTarget>(parameters, options, listener);
}

}  // namespace puckloop::exec
