// A main board whose program leaves out ninth clocks or gives too many, refuses what a device acknowledges,
// transmits and receives against what it agreed with the address byte, or makes a STOP or START behind an
// acknowledge: what its status bits and the bytes that it gets show, compared with the two wires, bit by bit
// (dsPIC30F Family Reference Manual, DS70068, sections 21.5 to 21.7; UM10204, 3.1.4 to 3.1.6).

#include "base/random.h"
#include "tests/exec/command.h"
#include "tests/kit/dspic_pieces.h"
#include "tests/wires/wire_slave.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <vector>

using namespace puckloop;
using exec::Outcome;
using exec::text_of;

namespace {

constexpr int kAddress = 0x20, kFirstByte = 0xA5;

/// Sends kFirstByte and the next ones, reads what comes.
const std::string kDevice = R"(
        goto main
        .org 0x200
main:   mov #0x7FF0, w0
        mov w0, SPLIM
        mov #0x6000, w15
        mov #0x20, w0
        mov w0, I2C1ADD
        mov #0x9000, w0
        mov w0, I2C1CON
        mov #0xA5, w11
loop:   btss IFS1, #0
        bra loop
        bclr IFS1, #0
        mov I2C1RCV, w1
        btss I2C1STAT, #2
        bra free
        mov w11, I2C1TRN
        inc w11, w11
free:   bset I2C1CON, #12
        bra loop
)";

struct Act {
    enum class Kind { Start, Restart, Transmit, Receive, Acknowledge, Stop } kind;
    int value = 0;  ///< byte, or ACKDT
};
using Kind = Act::Kind;

/// What the program sends of each activity: ACKSTAT and BCL, then the byte received newest.
struct Shown {
    int status = 0, received = 0;
    bool operator==(const Shown&) const = default;
};
constexpr int kRefused = 0x80, kCollision = 0x04;  // of I2CSTAT's high byte

class DeviceOnWires {
  public:
    void start() {
        mode_ = Mode::Address;
        count_ = 0;
        pulls_ = false;
    }
    void stop() {
        mode_ = Mode::Idle;
        count_ = 0;
        pulls_ = false;
    }
    /// In the clock that comes.
    bool holds_low() const {
        return count_ == 8 ? pulls_ : mode_ == Mode::Send && (byte_ >> (7 - count_) & 1) == 0;
    }
    bool clock(bool sda) {
        const bool line = sda && !holds_low();
        if (count_ < 8) {
            shift_ = (shift_ << 1 | (line ? 1 : 0)) & 0xFF;
            if (++count_ == 8 && mode_ == Mode::Send) loaded_ = false;
            if (count_ == 8)
                pulls_ = mode_ == Mode::Receive || (mode_ == Mode::Address && shift_ >> 1 == kAddress);
            return line;
        }
        count_ = 0;
        const bool sends = mode_ == Mode::Send ? !line : mode_ == Mode::Address && (shift_ & 1) != 0;
        if (mode_ == Mode::Address)
            mode_ = !pulls_ ? Mode::Idle : sends ? Mode::Send : Mode::Receive;
        else if (mode_ == Mode::Send && line)
            mode_ = Mode::Idle;
        if (mode_ == Mode::Send) serve();
        pulls_ = false;
        return line;
    }

  private:
    /// The device's program. I2CTRN takes nothing before what it holds is out.
    void serve() {
        if (!loaded_) byte_ = next_;
        loaded_ = true;
        next_ = (next_ + 1) & 0xFF;
    }

    enum class Mode { Idle, Address, Receive, Send } mode_ = Mode::Idle;
    int count_ = 0, shift_ = 0, byte_ = 0xFF, next_ = kFirstByte;
    bool pulls_ = false, loaded_ = false;
};

/// Up to the first collision.
std::vector<Shown> on_wires(const std::vector<Act>& acts) {
    DeviceOnWires device;
    std::vector<Shown> all;
    Shown now;
    for (const Act& act : acts) {
        bool collides = false;
        switch (act.kind) {
        case Kind::Start:
        case Kind::Restart:
        case Kind::Stop:
            collides = device.holds_low();
            if (!collides) act.kind == Kind::Stop ? device.stop() : device.start();
            break;
        case Kind::Transmit: {
            for (int bit = 7; bit >= 0 && !collides; --bit) {
                const bool one = (act.value >> bit & 1) != 0;
                collides = one && !device.clock(true);
                if (!one) device.clock(false);
            }
            if (!collides) now.status = device.clock(true) ? kRefused : 0;
            break;
        }
        case Kind::Receive:
            now.received = 0;
            for (int bit = 0; bit < 8; ++bit)
                now.received = now.received << 1 | (device.clock(true) ? 1 : 0);
            break;
        case Kind::Acknowledge:
            collides = !device.clock(act.value != 0) && act.value != 0;
            break;
        }
        if (collides) now.status |= kCollision;
        all.push_back(now);
        if (collides) break;
    }
    return all;
}

std::string program(const std::vector<Act>& acts) {
    std::string source = tests::kMain + tests::kUart1 + R"(
        mov #150, w0
        mov w0, I2CBRG
        mov #0x8000, w0
        mov w0, I2CCON
        mov #2000, w0           ; until the other board is ready
ready:  repeat #1000
        nop
        dec w0, w0
        bra nz, ready
)";
    for (const Act& act : acts) {
        switch (act.kind) {
        case Kind::Start:
            source += "        bset I2CCON, #0\n";
            break;
        case Kind::Restart:
            source += "        bset I2CCON, #1\n";
            break;
        case Kind::Stop:
            source += "        bset I2CCON, #2\n";
            break;
        case Kind::Receive:
            source += "        bset I2CCON, #3\n";
            break;
        case Kind::Acknowledge:
            source += fmt::format("        {} I2CCON, #5\n        bset I2CCON, #4\n",
                                  act.value != 0 ? "bset" : "bclr");
            break;
        case Kind::Transmit:
            source += fmt::format("        mov #0x{:x}, w0\n        mov w0, I2CTRN\n", act.value);
            break;
        }
        source += "        call done\n";
    }
    return source + R"(
end:    bra end
put:    btsc U1STA, #9
        bra put
        mov w1, U1TXREG
        return
done:   btss IFS0, #14          ; MI2CIF
        bra done
        bclr IFS0, #14
        mov I2CSTAT, w2
        btst I2CSTAT, #1        ; RBF
        bra z, same
        mov I2CRCV, w5
same:   lsr w2, #8, w1
        call put
        mov w5, w1
        call put
        btst I2CSTAT, #10       ; BCL
        bra nz, end
        return
)";
}

/// Transfers whose clocks keep to nothing: ninth clocks left out, in any number and anywhere, and given too
/// often; bytes transmitted where the device sends; STOP and START behind an acknowledge.
class Drawn {
  public:
    explicit Drawn(RandomStream& random) : random_(random) {}

    std::vector<Act> acts() {
        for (int transfer = 0; transfer < kTransfers; ++transfer) {
            add(Kind::Start);
            address();
            for (auto n = random_.below(7); n > 0; --n)
                reads_ ? act_where_it_sends() : act_where_it_receives();
            if (one_in(4)) {
                add(Kind::Restart);
                address();
                if (reads_) act_where_it_sends();
            }
            add(Kind::Stop);
        }
        return acts_;
    }

  private:
    static constexpr int kTransfers = 5;

    bool one_in(std::uint64_t n) { return random_.below(n) == 0; }
    int byte() {
        return static_cast<int>(one_in(4) ? 0xFF : one_in(2) ? random_.below(128) : random_.below(256));
    }
    void add(Kind kind, int value = 0) { acts_.push_back({kind, value}); }
    void address() {
        reads_ = one_in(2);
        place_ = 0;
        add(Kind::Transmit, (one_in(8) ? kAddress + 2 : kAddress) << 1 | (reads_ ? 1 : 0));
    }
    void act_where_it_receives() {
        switch (random_.below(8)) {
        case 0:
        case 1:
        case 2:
        case 3:
            return add(Kind::Receive);
        case 4:
        case 5:
            return add(Kind::Transmit, byte());
        default:
            return add(Kind::Acknowledge, one_in(3) ? 1 : 0);
        }
    }
    /// No acknowledge in a byte of the device's (deviation 3 of emu/dspic/peripherals/serial/i2c_master.h).
    void act_where_it_sends() {
        const auto die = random_.below(8);
        if (place_ == kNinth && die < 4) {
            place_ = 0;
            return add(Kind::Acknowledge, die == 0 ? 1 : 0);
        }
        if (die < 6) {
            place_ = kNinth;
            return add(Kind::Receive);
        }
        add(Kind::Transmit, byte());
    }

    static constexpr int kNinth = 8;
    RandomStream& random_;
    std::vector<Act> acts_;
    bool reads_ = false;
    int place_ = 0;  ///< 0 or kNinth, of a device that sends
};

std::vector<Shown> on_bench(const exec::Workbench& bench, const std::vector<Act>& acts) {
    const std::string master = bench.image("master.hex", exec::assembled(program(acts)));
    const std::string device =
        bench.image("device.hex", exec::assembled(kDevice, dspic::dspic33fj256gp710()));
    const Outcome run = bench.run("--board pic " + master + " --i2c-device rab=" + device + " --log " +
                                  bench.folder + "/log --seconds 0.4");
    INFO(run.err);
    CHECK(run.status == 0);
    const std::string csv = text_of(bench.folder + "/log/uart1.csv");
    std::vector<int> bytes;
    for (std::size_t at = 0; (at = csv.find(",tx,", at)) != std::string::npos;)
        bytes.push_back(std::stoi(csv.substr(at += 4, 2), nullptr, 16));
    std::vector<Shown> shown;
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2)
        shown.push_back({bytes[i] & (kRefused | kCollision), bytes[i + 1]});
    return shown;
}

}  // namespace

TEST_CASE("a main board that breaks its agreement finds on the bus what the wires show, drawn") {
    const auto drawn_seeds = static_cast<std::uint64_t>(wires::seeds(24));
    std::size_t collisions = 0, compared = 0, stops = 0;
    for (std::uint64_t seed = 1; seed <= drawn_seeds; ++seed) {
        RandomStream random(seed, "ninth clock");
        const std::vector<Act> acts = Drawn(random).acts();
        const exec::Workbench bench;
        const std::vector<Shown> expected = on_wires(acts), shown = on_bench(bench, acts);
        INFO("seed " << seed);
        CHECK(shown.size() == expected.size());
        for (std::size_t i = 0; i < std::min(shown.size(), expected.size()); ++i) {
            INFO("act " << i << " kind " << static_cast<int>(acts[i].kind) << " value " << acts[i].value);
            CHECK(shown[i].status == expected[i].status);
            if (i > 0 || acts[i].kind == Kind::Receive) CHECK(shown[i].received == expected[i].received);
            ++compared;
            stops += acts[i].kind == Kind::Stop && (expected[i].status & kCollision) == 0;
        }
        collisions += !expected.empty() && (expected.back().status & kCollision) != 0;
    }
    CHECK(collisions > drawn_seeds / 2);
    CHECK(compared > 8 * drawn_seeds);
    CHECK(stops > drawn_seeds / 2);
}
