// The range-and-bearing board's firmware on the host: I2C, both UARTs, and light at its twelve sensors.

#include "emu/dspic/devices/device.h"
#include "emu/rab_board/board.h"
#include "emu/rab_board/pin_table.h"
#include "firmware/host/dspic_host.h"
#include "firmware/host/input.h"
#include "firmware/host/register_objects.h"

#include <algorithm>
#include <utility>

int firmware_main();
void _T1Interrupt();
void _T3Interrupt();
void _U1RXInterrupt();
void _U1TXInterrupt();
void _ADC1Interrupt();
void _SI2C1Interrupt();
void _INT1Interrupt();
void _U2RXInterrupt();
void _U2TXInterrupt();

namespace hosted {

namespace {

namespace rab = puckloop::rab;
using puckloop::cosim::I2cPhase;
using puckloop::cosim::I2cPhaseKind;
using puckloop::cosim::Time;

constexpr Vector kRoutines[] = {{11, _T1Interrupt},   {16, _T3Interrupt},   {19, _U1RXInterrupt},
                                {20, _U1TXInterrupt}, {21, _ADC1Interrupt}, {24, _SI2C1Interrupt},
                                {28, _INT1Interrupt}, {38, _U2RXInterrupt}, {39, _U2TXInterrupt}};
constexpr Time kMicrosecond = 1'000'000;
constexpr Time kBit = 1'000'000'000'000 / 115'200;
constexpr Time kClock = 10 * kMicrosecond;  // of I2C
constexpr double kCharacter = 86.8;         // microseconds
constexpr double kChip = 98.0;
constexpr double kReady = 60e3;  // it has started
constexpr double kTail = 20e3, kLongest = 250e3;
constexpr std::uint8_t kAddress = 0x20;

Seen present;

class Watch : public rab::BoardListener {
  public:
    void signal_changed(rab::SignalId id, double value, Time) override {
        present.add(id);
        present.add(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)));
        ++present.other;
    }
    void emitters_changed(std::uint16_t on, Time) override { present.add(on); }
    void uart_sent(int unit, const puckloop::cosim::UartFrame& frame) override {
        present.add(static_cast<std::uint64_t>(unit) << 16 | frame.data);
        ++present.bytes_sent;
    }
    void i2c_answer(const I2cPhase& answer, Time) override {
        present.add(static_cast<std::uint64_t>(answer.ack) << 8 | answer.byte);
        ++present.other;
        open = false;
        acknowledged = answer.ack != 0;
    }
    void i2c_phase(int, const I2cPhase&) override {}

    bool open = false, acknowledged = false;
};

class Rab : public DspicHost {
  public:
    Rab(rab::Board& board, Watch& watch, Input input)
        : DspicHost(puckloop::dspic::dspic33fj256gp710(), board, {rab::kCrystalHertz, 0.0, {}},
                    PUCKLOOP_FIRMWARE "/rab/rab.hex", kRoutines),
          board_(board),
          watch_(watch),
          input_(input) {
        board.connect(chip());
    }

  private:
    struct Light {
        std::uint16_t sensors;  ///< that change
        bool on;
        double then;  ///< microseconds
    };

    Cycle act() override {
        board_.settle(time());
        if (static_cast<double>(time()) > kLongest * 1e6) throw InputEnds{};
        if (!phases_.empty()) return next_phase();
        if (!lights_.empty()) {
            const Light light = lights_.front();
            lights_.pop_front();
            show(light.sensors, light.on);
            return in(light.then);
        }
        if (input_.empty()) {
            if (ending_) throw InputEnds{};
            ending_ = true;
            return in(kTail);
        }
        if (!std::exchange(begun_, true) && input_.byte() & 1) return in(kReady);
        return begin(input_.byte());
    }

    Cycle next_phase() {
        constexpr double kPatience = 50e3;
        if (watch_.open) {
            waited_ += 20.0;
            if (waited_ > kPatience) fail("the I2C slave holds the bus for ever", 0, 0);
            return in(20.0);
        }
        waited_ = 0.0;
        I2cPhase phase = phases_.front();
        phases_.pop_front();
        phase.start = time();
        phase.clock_period = kClock;
        watch_.open = phase.kind != I2cPhaseKind::Stop;
        chip().i2c_slave_phase(1, phase);
        return in(100.0);
    }

    Cycle begin(std::uint8_t operation) {
        const int much = operation >> 3;
        switch (operation & 7) {
        case 0: {
            const int unit = much & 1 ? 1 : 2;
            chip().uart_receive(unit, character(input_.byte(), time(), kBit));
            return in(kCharacter + 10.0 * much);
        }
        case 1:  // writes of a register
            phase(I2cPhaseKind::Start, much & 16 ? input_.byte() : kAddress << 1);
            phase(I2cPhaseKind::Write, input_.byte());
            for (int i = 0; i < (much & 3); ++i)
                phase(I2cPhaseKind::Write, input_.byte());
            if (much & 4) phase(I2cPhaseKind::Stop, 0);
            return in(1.0);
        case 2:  // reads of registers
            phase(I2cPhaseKind::Start, kAddress << 1);
            phase(I2cPhaseKind::Write, input_.byte());
            phase(I2cPhaseKind::Start, kAddress << 1 | 1);
            for (int i = 0; i < much + 1; ++i)
                phases_.push_back({I2cPhaseKind::Read, 0, static_cast<std::uint8_t>(i < much)});
            phase(I2cPhaseKind::Stop, 0);
            return in(1.0);
        case 3: {  // a frame, or something like it
            const auto payload = static_cast<std::uint32_t>(input_.byte() | input_.byte() << 8);
            const int wrong = much & 4 ? input_.byte() : -1;
            frame(sensors(much), payload, wrong, much & 8 ? 0.9 + input_.byte() / 1280.0 : 1.0);
            return in(1.0);
        }
        case 4:
            return in(300.0 * (much + 1));
        case 5: {
            const auto id = static_cast<rab::SignalId>(rab::kPeak + much % rab::kSensorCount);
            set(id, 16.0 * input_.byte());
            return in(10.0);
        }
        case 6:
            show(sensors(much), input_.byte() & 1);
            return in(10.0 * input_.byte());
        default:
            set_access_cycles(1 + (much & 7));
            return in(1.0);
        }
    }

    /// Which sensors see light.
    std::uint16_t sensors(int much) {
        return static_cast<std::uint16_t>((input_.byte() | (much & 3) << 8) & 0xFFF);
    }

    /// Preamble of six chips, sixteen bits, four of check: a 1 is light and dark, a 0 dark and light.
    void frame(std::uint16_t sensors, std::uint32_t payload, int wrong, double scale) {
        constexpr int kBits = 16, kCheckBits = 4, kPreamble = 6;
        const auto check = -static_cast<unsigned>(__builtin_popcount(payload)) & 0xFu;
        std::vector<bool> chips(kPreamble, true);
        const auto put = [&chips](bool bit) {
            chips.push_back(bit);
            chips.push_back(!bit);
        };
        for (int i = 0; i < kBits; ++i)
            put(payload >> i & 1);
        for (int i = kCheckBits - 1; i >= 0; --i)
            put(check >> i & 1);
        if (wrong >= 0) {
            const auto at = static_cast<std::size_t>(wrong) % chips.size();
            chips[at] = !chips[at];
        }
        for (const bool on : chips)
            lights_.push_back({sensors, on, kChip * scale});
        lights_.push_back({sensors, false, 10 * kChip});
    }

    void show(std::uint16_t sensors, bool on) {
        for (int i = 0; i < rab::kSensorCount; ++i)
            if (sensors >> i & 1) set(static_cast<rab::SignalId>(rab::kDemodulator + i), on ? 1.0 : 0.0);
    }
    void phase(I2cPhaseKind kind, int byte) { phases_.push_back({kind, static_cast<std::uint8_t>(byte), 1}); }
    Cycle in(double microseconds) const { return cycle() + std::max<Cycle>(1, cycles(microseconds)); }
    void set(rab::SignalId id, double value) {
        if (const auto port = board_.set_signal(id, value, time())) chip().pins_changed(*port);
    }

    rab::Board& board_;
    Watch& watch_;
    Input input_;
    std::deque<I2cPhase> phases_;
    std::deque<Light> lights_;
    double waited_ = 0.0;
    bool ending_ = false, begun_ = false;
};

}  // namespace

void no_interrupts(unsigned cycles) {
    static_cast<DspicHost&>(Host::present()).no_interrupts(cycles);
}
void idle() {
    Host::present().idle();
}

void assembly(const char* text) {
    static_cast<DspicHost&>(Host::present()).assembly(text);
}

const Seen& seen() {
    return present;
}

void run_input(std::span<const std::uint8_t> bytes) {
    present = {};
    Watch watch;
    rab::Board board({}, watch);
    Rab host(board, watch, Input(bytes));
    run_firmware(&firmware_main);
}

}  // namespace hosted
