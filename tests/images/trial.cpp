#include "tests/images/trial.h"

#include "protocols/infrared/rc5.h"

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

void Trial::press(int key, int address) {
    constexpr double kMicrosecond = 1e-6;
    const double begin = rig_->now_s();
    toggle_ = !toggle_;
    for (const protocols::Rc5Edge& edge : protocols::rc5_frame(toggle_, address, key)) {
        rig_->run_to(begin + edge.microseconds * kMicrosecond);
        rig_->set("remote", edge.high ? 1 : 0);
    }
    rig_->run_to(begin + protocols::kRc5RepeatMicroseconds * kMicrosecond);
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

std::string drives_by_remote(Trial& trial) {
    constexpr int kAddress = 8;  // 0 or 8 is heard
    trial.press(2, kAddress);
    const auto ahead = trial.drives(1.0);
    expect(ahead[0] > 400 && std::abs(ahead[0] - ahead[1]) < 5,
           fmt::format("key 2: {}, {}", ahead[0], ahead[1]));
    trial.press(5, kAddress);
    const auto rest = trial.drives(0.5);
    expect(rest[0] == 0 && rest[1] == 0, "key 5: goes on");
    trial.press(4, kAddress + 1);
    const auto deaf = trial.drives(0.5);
    expect(deaf[0] == 0 && deaf[1] == 0, "hears another address");
    trial.press(4, kAddress);
    const auto left = trial.drives(1.0);
    expect(left[0] < -400 && std::abs(left[0] + left[1]) < 5, fmt::format("key 4: {}, {}", left[0], left[1]));
    trial.press(0, kAddress);
    expect(trial.plays(0.3) > 0.05, "key 0: no sound");
    return "keys 2, 5, 4, 0: ahead, stop, left, a sound; another address is not heard";
}

void expect(bool right, const std::string& seen) {
    if (!right) throw Wrong{seen};
}

std::string shows_the_ground(Trial& trial) {
    trial.set("acc_x", 2048 + 400);
    trial.run(0.3);
    const std::string right = trial.leds();
    trial.set("acc_x", 2048 - 400);
    trial.run(0.3);
    const std::string left = trial.leds();
    expect(right.size() == 1 && left.size() == 1 && right != left, "LEDs " + right + ", " + left);
    return fmt::format("tilted to either side: LED {} and LED {}", right, left);
}

std::string locates_a_clap(Trial& trial) {
    for (int i = 0; i < 3; ++i)
        trial.set(fmt::format("mic_level{}", i), 1500);
    trial.run(0.02);
    for (int i = 0; i < 3; ++i)
        trial.set(fmt::format("mic_level{}", i), 0);
    double turned = 0.0;
    for (int i = 0; i < 30; ++i) {
        const auto there = trial.drives(0.1);
        turned += std::abs(there[0]) + std::abs(there[1]);
    }
    expect(turned > 10 || !trial.leds().empty(), "nothing after a clap");
    return "a clap: shows a direction and turns (directions: sound.md)";
}

}  // namespace puckloop::images
