#include "tests/images/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::images {

Trial::Trial(const std::string& image_file, const Setup& setup)
    : rig_(std::make_unique<exec::Rig>(setup.board, image_file, setup.revision, setup.uart2_baud)) {
    if (setup.board == "pic") rig_->set("selector", setup.selector);
    rig_->run_for(setup.boot);
}

std::string Trial::ask(const std::string& text, int unit, double seconds) {
    rig_->take(unit);
    rig_->send(unit, {text.begin(), text.end()});
    rig_->run_for(seconds);
    return rig_->take_text(unit);
}

std::string Trial::leds() {
    std::string on;
    for (int i = 0; i < 8; ++i)
        if (rig_->get(fmt::format("led{}", i)) > 0) on += fmt::format("{}{}", on.empty() ? "" : " ", i);
    return on;
}

std::array<double, 2> Trial::drives(double seconds) {
    const std::array<double, 2> before{rig_->get("wheel_left"), rig_->get("wheel_right")};
    rig_->run_for(seconds);
    return {rig_->get("wheel_left") - before[0], rig_->get("wheel_right") - before[1]};
}

double Trial::plays(double seconds) {
    constexpr double kLook = 0.97e-3;  // s: between two looks a tone is at another place
    double most = 0.0;
    for (double end = rig_->now_s() + seconds; rig_->now_s() < end;) {
        rig_->run_for(kLook);
        most = std::max(most, std::abs(rig_->get("speaker")));
    }
    return most;
}

std::string Trial::troubles() {
    const dspic::ChipReport& report = rig_->chip().report();
    std::string all;
    for (const auto& touch : report.unmodelled)
        all += fmt::format(" {} at {:#x}", touch.name, touch.pc);
    if (!report.traps.empty()) all += fmt::format(" {} traps", report.traps.size());
    return all;
}

void expect(bool right, const std::string& seen) {
    if (!right) throw Wrong{seen};
}

}  // namespace puckloop::images
