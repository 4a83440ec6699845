// The TAM's firmware on the host: the radio module's serial line, the console, infra-red light and light
// barriers.

#include "firmware/host/avr_host.h"
#include "firmware/host/input.h"
#include "firmware/host/register_objects.h"

#include <algorithm>
#include <utility>

int firmware_main();
void __vector_9();
void __vector_12();
void __vector_16();
void __vector_20();
void __vector_21();
void __vector_28();
void __vector_29();

namespace hosted {

namespace {

namespace tam = puckloop::tam;
using puckloop::cosim::Time;

constexpr Vector kRoutines[] = {{9, __vector_9},   {12, __vector_12}, {16, __vector_16}, {20, __vector_20},
                                {21, __vector_21}, {28, __vector_28}, {29, __vector_29}};
constexpr Time kRadioBit = 1'000'000'000'000 / 9615, kConsoleBit = 1'000'000'000'000 / 57'600;
constexpr double kRadioCharacter = 1040.0, kConsoleCharacter = 174.0;  // microseconds
constexpr double kReady = 200e3;                                       // it has started
constexpr double kTail = 50e3, kLongest = 1.5e6;
constexpr int kRadio = 1, kConsole = 0;
constexpr std::uint16_t kStatus = 0x5F;  // SREG
constexpr std::uint8_t kInterrupts = 0x80;

Seen present;

class Watch : public tam::BoardListener {
  public:
    void signal_changed(tam::SignalId id, double value, Time) override {
        present.add(id);
        present.add(static_cast<std::uint64_t>(value * 256.0));
        ++present.other;
    }
    void uart_sent(int unit, const puckloop::cosim::UartFrame& frame) override {
        present.add(static_cast<std::uint64_t>(unit) << 16 | frame.data);
        ++present.bytes_sent;
    }
};

class Tam : public AvrHost {
  public:
    Tam(tam::Board& board, Input input) : AvrHost(board, kRoutines), input_(input) {}

  private:
    Cycle act() override {
        if (static_cast<double>(time()) > kLongest * 1e6) throw InputEnds{};
        if (!characters_.empty()) {
            receive(characters_.front());
            characters_.pop_front();
            return in(kRadioCharacter);
        }
        if (!halves_.empty()) {
            const double half = halves_.front();
            halves_.pop_front();
            lit_ = !lit_ && !halves_.empty();
            board().set_signal(tam::kProximitySense, lit_ ? 1.0 : 0.0);
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
            return in(kRadioCharacter + 100.0 * much);
        case 1:  // a frame of the radio module's with a good check
        case 2: {
            std::vector<std::uint8_t> data{kKinds[static_cast<std::size_t>(much & 3)]};
            for (int i = 0; i < much + (operation & 2 ? 16 : 0); ++i)
                data.push_back(input_.byte());
            frame(data);
            return in(1.0);
        }
        case 3:  // the coordinator was found; then it commands
            frame({0x88, 1, 'D', 'N', 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8});
            frame({0x90, 1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 1, input_.byte(), input_.byte(), input_.byte(),
                   input_.byte()});
            return in(1.0);
        case 4:
            return in(2000.0 * (much + 1));
        case 5: {
            const auto symbols = ircom_symbols(input_.byte()) ^ (much & 8 ? input_.byte() : 0);
            const double scale = much & 16 ? 0.9 + input_.byte() / 1280.0 : 1.0;
            const auto halves = ircom_halves(static_cast<std::uint16_t>(symbols), scale);
            halves_.assign(halves.begin(), halves.end());
            return in(1.0);
        }
        case 6: {
            const auto id = static_cast<tam::SignalId>(tam::kBarrier + (much & 7));
            board().set_signal(id, (much & 7) < 2 ? (much & 8) / 8.0 : input_.byte() / 51.0);
            return in(100.0);
        }
        default:
            return disturb(much);
        }
    }

    Cycle disturb(int kind) {
        auto broken = character(input_.byte(), time(), kRadioBit);
        switch (kind & 3) {
        case 0:
            broken.is_break = 1;
            broken.data = 0;
            board().uart_receive(kRadio, broken);
            break;
        case 1:
            board().uart_receive(kConsole, character(input_.byte(), time(), kConsoleBit));
            return in(kConsoleCharacter);
        case 2:
            set_access_cycles(1 + (broken.data & 15));
            return in(1.0);
        default:
            broken.bit_period += broken.bit_period * static_cast<std::int8_t>(input_.byte()) / 1280;
            board().uart_receive(kRadio, broken);
        }
        return in(kRadioCharacter);
    }

    void frame(const std::vector<std::uint8_t>& data) {
        constexpr std::uint8_t kStart = 0x7E, kEscape = 0x7D, kFlip = 0x20, kXon = 0x11, kXoff = 0x13;
        const auto put = [&](std::uint8_t byte) {
            if (byte == kStart || byte == kEscape || byte == kXon || byte == kXoff) {
                characters_.push_back(kEscape);
                byte ^= kFlip;
            }
            characters_.push_back(byte);
        };
        characters_.push_back(kStart);
        put(0);
        put(static_cast<std::uint8_t>(data.size()));
        std::uint8_t sum = 0;
        for (const std::uint8_t byte : data) {
            sum = static_cast<std::uint8_t>(sum + byte);
            put(byte);
        }
        put(static_cast<std::uint8_t>(0xFF - sum));
    }

    Cycle in(double microseconds) const { return cycle() + std::max<Cycle>(1, cycles(microseconds)); }
    void receive(std::uint8_t byte) { board().uart_receive(kRadio, character(byte, time(), kRadioBit)); }

    /// AT response, transmit status, receive, modem status.
    static constexpr std::uint8_t kKinds[] = {0x88, 0x8B, 0x90, 0x8A};

    Input input_;
    std::deque<std::uint8_t> characters_;
    std::deque<double> halves_;
    bool lit_ = false, ending_ = false, begun_ = false;
};

}  // namespace

void idle() {
    Host::present().idle();
}
void enable(bool on) {
    const std::uint8_t status = read_byte(kStatus);
    write_byte(kStatus, static_cast<std::uint8_t>(on ? status | kInterrupts : status & ~kInterrupts));
}
void feed_watchdog() {
    static_cast<AvrHost&>(Host::present()).feed_watchdog();
}

const Seen& seen() {
    return present;
}

void run_input(std::span<const std::uint8_t> bytes) {
    present = {};
    Watch watch;
    tam::Board board({}, watch);
    Tam host(board, Input(bytes));
    run_firmware(&firmware_main);
}

}  // namespace hosted
