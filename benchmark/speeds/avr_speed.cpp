#include "benchmark/speeds/avr_speed.h"

#include "base/files/shipped_files.h"
#include "benchmark/measures/processor_seconds.h"
#include "benchmark/measures/timed_run.h"
#include "benchmark/speeds/prompt_module.h"
#include "emu/avr/chip/chip.h"
#include "emu/tam_avr/board.h"

#include <fmt/format.h>

#include <ctime>
#include <deque>
#include <string>

namespace puckloop::tools {

namespace {

using cosim::Time;

image::AvrImage load(const std::filesystem::path& image) {
    return image::load_avr_image(image.string(), avr::atmega1284p().image_part());
}

/// The board with its module, whose answers come in byte by byte.
class Booth : private tam::BoardListener {
  public:
    explicit Booth(const std::filesystem::path& image) : board_({}, *this) { board_.load(load(image)); }

    void run_until(Time until) {
        constexpr Time kStep = cosim::kMillisecond;
        while (board_.now() < until) {
            if (!answers_.empty()) {
                const Time stop_bit = board_.now() + kBit * 9;
                cosim::UartFrame frame;
                frame.bit_period = kBit;
                frame.start = board_.now();
                frame.data = answers_.front();
                answers_.pop_front();
                board_.run_until(stop_bit);
                board_.uart_receive(tam::kXBeeUnit, frame);
                board_.run_until(stop_bit + kBit);
            } else {
                board_.run_until(std::min(until, board_.now() + kStep));
            }
        }
    }
    Time now() const { return board_.now(); }

  private:
    static constexpr Time kBit = cosim::kSecond / 9600;
    void signal_changed(tam::SignalId id, double value, Time) override {
        if (id == tam::kXBeeReset && value == 0.0) add(PromptModule::hello());
    }
    void uart_sent(int unit, const cosim::UartFrame& frame) override {
        if (unit == tam::kXBeeUnit) add(module_.take(static_cast<std::uint8_t>(frame.data)));
    }
    void add(const std::vector<std::uint8_t>& bytes) {
        answers_.insert(answers_.end(), bytes.begin(), bytes.end());
    }

    PromptModule module_;
    std::deque<std::uint8_t> answers_;
    tam::Board board_;
};

std::optional<double> ask_simavr(const char* what, const std::filesystem::path& image, double slice_s) {
    const std::filesystem::path simavr = shipped_program("simavr_speed", "benchmark");
    if (simavr.empty()) return std::nullopt;  // built where libsimavr is installed, and never shipped
    const ProgramTiming timing =
        time_program({simavr.string(), what, image.string(), fmt::format("{}", slice_s)});
    // libsimavr prints what it loads; the figure is the last line.
    const std::string text = timing.output.substr(0, timing.output.find_last_not_of('\n') + 1);
    return std::stod(text.substr(text.find_last_of('\n') + 1));
}

}  // namespace

double avr_program_speed(const std::filesystem::path& image, double slice_s) {
    avr::Pins pins;
    avr::Chip chip(avr::atmega1284p(), pins);
    chip.load(load(image));
    chip.power_on();
    constexpr Time kStep = 20 * cosim::kMillisecond;
    chip.run_until(kStep);
    const avr::Cycle first = chip.cycle();
    const double start = processor_seconds();
    double elapsed = 0;
    while ((elapsed = processor_seconds() - start) < slice_s)
        chip.run_until(chip.now() + kStep);
    constexpr double kMillions = 1e-6;
    return static_cast<double>(chip.cycle() - first) / elapsed * kMillions;
}

double tam_idle_speed(const std::filesystem::path& image, double slice_s) {
    Booth booth(image);
    booth.run_until(cosim::from_seconds(kTamStartUp));
    const Time begin = booth.now();
    const double start = processor_seconds();
    double elapsed = 0;
    while ((elapsed = processor_seconds() - start) < slice_s)
        booth.run_until(booth.now() + 50 * cosim::kMillisecond);
    return cosim::to_seconds(booth.now() - begin) / elapsed;
}

std::optional<double> simavr_program_speed(const std::filesystem::path& image, double slice_s) {
    return ask_simavr("program", image, slice_s);
}

std::optional<double> simavr_idle_speed(const std::filesystem::path& image, double slice_s) {
    return ask_simavr("tam", image, slice_s);
}

}  // namespace puckloop::tools
