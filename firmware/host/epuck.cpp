// The e-puck main board's firmware on the host: UART2 and the light at its eight infra-red sensors.

#include "emu/dspic/devices/device.h"
#include "emu/pic/board.h"
#include "firmware/host/dspic_host.h"
#include "firmware/host/input.h"

#include <algorithm>
#include <utility>

int firmware_main();
void _T1Interrupt();
void _T4Interrupt();
void _T5Interrupt();
void _ADCInterrupt();
void _U2RXInterrupt();
void _U2TXInterrupt();
#ifdef IRCOM
void _T2Interrupt();
#endif

namespace hosted {

namespace {

namespace pic = puckloop::pic;
using puckloop::cosim::Time;

constexpr Vector kRoutines[] = {{11, _T1Interrupt},   {19, _ADCInterrupt},
                                {29, _T4Interrupt},   {30, _T5Interrupt},
#ifdef IRCOM
                                {14, _T2Interrupt},
#endif
                                {32, _U2RXInterrupt}, {33, _U2TXInterrupt}};
#ifdef IRCOM
constexpr const char* kImage = PUCKLOOP_FIRMWARE "/epuck/epuck_ircom.hex";
#else
constexpr const char* kImage = PUCKLOOP_FIRMWARE "/epuck/epuck.hex";
#endif
constexpr Time kBit = 1'000'000'000'000 / 115'200;
constexpr double kCharacter = 86.8;   // microseconds
constexpr double kReady = 20e3;       // it has started
constexpr double kTail = 30e3;        // what is under way at an input's end is seen through
constexpr double kLongest = 600e3;    // simulated
constexpr std::uint8_t kRecord = 12;  // bytes

Seen present;

/// What leaves the board.
class Watch : public pic::BoardListener {
  public:
    void signal_changed(pic::SignalId id, double value, puckloop::dspic::Cycle) override {
        present.add(id);
        present.add(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)));
        ++present.other;
    }
    void uart_sent(int, const puckloop::cosim::UartFrame& frame) override {
        present.add(frame.data);
        ++present.bytes_sent;
    }
    void i2c_phase(int, const puckloop::cosim::I2cPhase&) override { ++present.other; }
};

class Epuck : public DspicHost {
  public:
    Epuck(pic::Board& board, Input input)
        : DspicHost(puckloop::dspic::dspic30f6014a(), board, {}, kImage, kRoutines),
          board_(board),
          input_(input) {}

  private:
    Cycle act() override {
        board_.settle(cycle());
        if (static_cast<double>(time()) > kLongest * 1e6) throw InputEnds{};
        if (!characters_.empty()) {
            receive(characters_.front());
            characters_.pop_front();
            return in(kCharacter);
        }
        if (!halves_.empty()) {
            const double half = halves_.front();
            halves_.pop_front();
            light(pic::kInfraredLight, lit_ ? 0.0 : strength_);
            lit_ = !lit_;
            if (halves_.empty() && lit_) light(pic::kInfraredLight, 0.0), lit_ = false;
            return in(half);
        }
        if (input_.empty()) {
            if (ending_) throw InputEnds{};
            ending_ = true;
            return in(kTail);
        }
        if (!std::exchange(begun_, true) && input_.byte() & 1) return in(kReady);
        return begin(input_.byte());
    }

    Cycle begin(std::uint8_t operation) {
        const int much = operation >> 3;
        switch (operation & 7) {
        case 0:
            receive(input_.byte());
            return in(kCharacter + 20.0 * much);
        case 1:  // one actuator record, or its first bytes
            for (int i = 0; i < std::min<int>(kRecord, much + 1); ++i)
                characters_.push_back(input_.byte());
            return in(kCharacter);
        case 2:  // one that drives
            for (int i = 0; i < kRecord; ++i)
                characters_.push_back(i < 4 ? input_.byte() : 0);
            return in(kCharacter);
        case 3:
            characters_ = {1, 0, 0, 0, 0};  // a program's start
            return in(kCharacter);
        case 4:
            return in(1000.0 * (much + 1));
        case 5:
            sensor_ = static_cast<std::uint16_t>(much & 7);
            light(much & 8 ? pic::kAmbient : pic::kProximity, 16.0 * input_.byte());
            return in(100.0);
        case 6: {  // a word of a neighbour's, or something like it
            sensor_ = static_cast<std::uint16_t>(much & 7);
            strength_ = 8.0 * input_.byte();
            const std::uint8_t word = input_.byte();
            const auto symbols = ircom_symbols(word) ^ (much & 8 ? input_.byte() : 0);
            const double scale = much & 16 ? 0.9 + input_.byte() / 1280.0 : 1.0;
            const auto halves = ircom_halves(static_cast<std::uint16_t>(symbols), scale);
            halves_.assign(halves.begin(), halves.end());
            return in(1.0);
        }
        default:
            return disturb(much);
        }
    }

    Cycle disturb(int kind) {
        auto frame = character(input_.byte(), time(), kBit);
        switch (kind & 3) {
        case 0:
            frame.is_break = 1;
            frame.data = 0;
            chip().uart_receive(2, frame);
            break;
        case 1:
            frame.bit_period += frame.bit_period * (static_cast<std::int8_t>(input_.byte())) / 1280;
            chip().uart_receive(2, frame);
            break;
        case 2:
            set_access_cycles(1 + (frame.data & 15));
            return in(1.0);
        default:
            set(pic::kBatteryVoltage, 3.0 + frame.data / 256.0);
            chip().supply_changed();
        }
        return in(kCharacter);
    }

    Cycle in(double microseconds) const { return cycle() + std::max<Cycle>(1, cycles(microseconds)); }
    void receive(std::uint8_t byte) { chip().uart_receive(2, character(byte, time(), kBit)); }
    void light(pic::SignalId id, double value) { set(static_cast<pic::SignalId>(id + sensor_), value); }
    void set(pic::SignalId id, double value) {
        if (const auto port = board_.set_signal(id, value, cycle())) chip().pins_changed(*port);
    }

    pic::Board& board_;
    Input input_;
    std::deque<std::uint8_t> characters_;
    std::deque<double> halves_;
    std::uint16_t sensor_ = 0;
    double strength_ = 0.0;
    bool lit_ = false, ending_ = false, begun_ = false;
};

}  // namespace

void no_interrupts(unsigned cycles) {
    static_cast<DspicHost&>(Host::present()).no_interrupts(cycles);
}
void idle() {
    Host::present().idle();
}

const Seen& seen() {
    return present;
}

void run_input(std::span<const std::uint8_t> bytes) {
    present = {};
    Watch watch;
    pic::Board board({}, watch);
    Epuck host(board, Input(bytes));
    run_firmware(&firmware_main);
}

}  // namespace hosted
