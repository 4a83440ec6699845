#include "tests/framing/uart_chips.h"

#include "emu/dspic/layouts/layout.h"
#include "protocols/serial/uart_sampling.h"
#include "tests/framing/avr_usart_bench.h"
#include "tests/framing/dspic_uart_bench.h"

namespace puckloop::framing {

namespace {

class Dspic : public UartChip {
  public:
    Dspic(bool family_33f, bool high_speed, double ppm) : bench_(family_33f, ppm), high_speed_(high_speed) {}

    void set(const Format& format, std::uint32_t divisor) override {
        divisor_ = divisor;
        bench_.enable(format, divisor, high_speed_);
        phase_ = bench_.now + 1;
    }
    void deliver(const cosim::UartFrame& frame, cosim::Time at) override {
        bench_.go(bench_.clock.first_cycle_at(at));
        bench_.uart.receive(frame, bench_.now);
    }
    void run_to(cosim::Time time) override { bench_.go(bench_.clock.first_cycle_at(time)); }
    std::vector<Character> take() override {
        std::vector<Character> out;
        for (std::uint16_t sta; (sta = bench_.sta()) & DspicUartBench::kUrxda;)
            out.push_back({bench_.data(), (sta & DspicUartBench::kFerr) != 0,
                           (sta & DspicUartBench::kPerr) != 0, false});
        return out;
    }
    bool send(std::uint16_t data) override { return bench_.send(data); }
    const std::vector<cosim::UartFrame>& sent() const override { return bench_.pins.frames; }
    const cosim::ClockDomain& clock() const override { return bench_.clock; }
    int ticks() const override { return high_speed_ ? 4 : 16; }

  private:
    DspicUartBench bench_;
    bool high_speed_;
};

class Avr : public UartChip {
  public:
    Avr(bool double_speed, double ppm) : bench_(ppm), double_speed_(double_speed) {}

    void set(const Format& format, std::uint32_t divisor) override {
        divisor_ = divisor;
        phase_ = bench_.enable(format, divisor, double_speed_);
    }
    void deliver(const cosim::UartFrame& frame, cosim::Time at) override {
        bench_.go(bench_.clock.first_cycle_at(at));
        bench_.usart.receive(frame, bench_.now);
    }
    void run_to(cosim::Time time) override { bench_.go(bench_.clock.first_cycle_at(time)); }
    std::vector<Character> take() override {
        std::vector<Character> out;
        for (std::uint8_t a; (a = bench_.status()) & AvrUsartBench::kRxc;)
            out.push_back({bench_.data(), (a & AvrUsartBench::kFe) != 0, (a & AvrUsartBench::kUpe) != 0,
                           (a & AvrUsartBench::kDor) != 0});
        return out;
    }
    bool send(std::uint16_t data) override { return bench_.send(data); }
    const std::vector<cosim::UartFrame>& sent() const override { return bench_.pins.frames; }
    const cosim::ClockDomain& clock() const override { return bench_.clock; }
    int ticks() const override { return double_speed_ ? 8 : 16; }

  private:
    AvrUsartBench bench_;
    bool double_speed_;
};

template <bool kFamily33f, bool kHighSpeed>
std::unique_ptr<UartChip> dspic(double ppm) {
    return std::make_unique<Dspic>(kFamily33f, kHighSpeed, ppm);
}
template <bool kDoubleSpeed>
std::unique_ptr<UartChip> avr(double ppm) {
    return std::make_unique<Avr>(kDoubleSpeed, ppm);
}

}  // namespace

void UartChip::receive(const cosim::UartFrame& frame) {
    deliver(frame, protocols::stop_bit_start(frame));
}

const std::vector<ChipKind>& chip_kinds() {
    static const std::vector<Format> dspic_formats{{8, 0}, {8, 1}, {8, 2}, {9, 0}, {8, 0, 2}, {8, 2, 2}};
    static const std::vector<Format> avr_formats{{8, 0}, {8, 1}, {8, 2}, {9, 0}, {9, 2}, {5, 0}, {7, 1}};
    static const std::vector<ChipKind> kinds{
        {"dsPIC30F, 16x", 16, dspic_formats, dspic<false, false>},
        {"dsPIC33FJ, 16x", 16, dspic_formats, dspic<true, false>},
        {"dsPIC33FJ, BRGH 4x", 4, dspic_formats, dspic<true, true>},
        {"ATmega1284P, 16x", 16, avr_formats, avr<false>},
        {"ATmega1284P, U2X 8x", 8, avr_formats, avr<true>},
    };
    return kinds;
}

}  // namespace puckloop::framing
