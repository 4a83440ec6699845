#include "linuxboard/control/rab/rab_board.h"

#include <algorithm>
#include <cerrno>
#include <vector>

namespace puckloop::control {

using namespace rab;

namespace {

constexpr double kSettle = 0.020;  // s around taking the light of the moment for darkness
constexpr int kByteBits = 8;

std::uint8_t byte_of(std::uint32_t payload, int index) {
    return static_cast<std::uint8_t>(payload >> (kByteBits * index));
}

std::uint32_t join(std::uint8_t high, std::uint8_t low) {
    return static_cast<std::uint32_t>(high) << kByteBits | low;
}

/// Messages of one operation, with their bytes.
class Operation {
  public:
    void write(std::initializer_list<std::uint8_t> bytes) { write(std::vector(bytes)); }
    void write(std::vector<std::uint8_t> bytes) { written_.push_back(std::move(bytes)); }
    std::vector<I2cMessage> messages() {
        std::vector<I2cMessage> out;
        for (std::vector<std::uint8_t>& bytes : written_)
            out.push_back({false, bytes});
        return out;
    }

  private:
    std::vector<std::vector<std::uint8_t>> written_;
};

/// The payload's bytes above the lowest. Two bytes go the way every firmware of the board knows; with more,
/// all bytes written to one register go there one after the other, which shifts them in.
void store_high_bytes(Operation& operation, int bytes, std::uint32_t payload) {
    if (bytes == 2) operation.write({kAux, byte_of(payload, 1)});
    if (bytes <= 2) return;
    std::vector<std::uint8_t> shifted{kAuxShift};
    for (int index = bytes - 1; index >= 1; --index)
        shifted.push_back(byte_of(payload, index));
    operation.write(std::move(shifted));
}

}  // namespace

RabBoard::RabBoard(I2cDevice& device, Clock& clock, RabBoardSettings settings)
    : device_(device), clock_(clock), settings_(settings) {}

bool RabBoard::transfer(std::span<const I2cMessage> messages) {
    int error = 0;
    for (int tried = 0; tried < settings_.tries; ++tried) {
        if (tried > 0) ++counters_.retries;
        error = device_.transfer(messages);
        if (error == 0) {
            ++counters_.transfers;
            failed_in_a_row_ = 0;
            return true;
        }
        if (error == ETIMEDOUT) break;  // a bus that hangs: trying again at once only keeps the caller
    }
    ++counters_.failures;
    ++failed_in_a_row_;
    last_error_ = error;
    return false;
}

bool RabBoard::write(std::uint8_t number, std::uint8_t value) {
    std::array<std::uint8_t, 2> bytes{number, value};
    const I2cMessage message{false, bytes};
    return transfer({&message, 1});
}

bool RabBoard::initialise() {
    const auto bits = static_cast<std::uint8_t>(kByteBits * settings_.bytes);
    if (!repeat_range() || !write(kBits, bits) || !write(kCompute, 0)) return false;
    clock_.sleep_until(clock_.now() + kSettle);
    if (!write(kBaseline, 0)) return false;
    clock_.sleep_until(clock_.now() + kSettle);
    if (!write(kBits, bits)) return false;
    RabPacket old;
    for (int i = 0; i <= kQueue; ++i) {
        const RabPoll found = poll(old);
        if (found == RabPoll::Failed) return false;
        if (found == RabPoll::Empty) break;
    }
    return true;
}

bool RabBoard::repeat_range() {
    return write(kRange, static_cast<std::uint8_t>(settings_.range));
}

/// Register by register, a byte each, in one operation: works with every firmware.
bool RabBoard::read_singly(std::array<std::uint8_t, 12>& values) {
    std::array<std::uint8_t, 12> numbers{};
    std::vector<I2cMessage> messages;
    const auto want = [&](std::uint8_t number) {
        numbers[number] = number;
        messages.push_back({false, {&numbers[number], 1}});
        messages.push_back({true, {&values[number], 1}});
    };
    for (std::uint8_t index = 0; index < 2 && settings_.bytes > 2; ++index)
        if (settings_.bytes == 4 || index == 1) want(static_cast<std::uint8_t>(kData3 + index));
    if (settings_.bytes > 1) want(kData1);
    want(kData1 + 1);
    for (std::uint8_t number = kBearing; number < kPeak; ++number)
        want(number);
    return transfer(messages);
}

/// Runs of registers: less than half the time on the bus. The board gives the first register of a run twice
/// (fact sheet 2.2), which is how to find that it counts as expected; one that does not is read singly from
/// then on.
bool RabBoard::read_burst(std::array<std::uint8_t, 12>& values) {
    std::array<std::uint8_t, 1> low{kData1};
    std::array<std::uint8_t, 1> high{kData3};
    std::array<std::uint8_t, 7> low_run{};
    std::array<std::uint8_t, 3> high_run{};
    const std::array<I2cMessage, 4> messages{
        {{false, low}, {true, low_run}, {false, high}, {true, high_run}}};
    if (!transfer(std::span(messages).first(settings_.bytes > 2 ? 4 : 2))) return false;
    if (low_run[0] != low_run[1] || high_run[0] != high_run[1]) {
        settings_.burst = false;
        return read_singly(values);
    }
    std::copy(low_run.begin() + 1, low_run.end(), values.begin() + kData1);
    std::copy(high_run.begin() + 1, high_run.end(), values.begin() + kData3);
    return true;
}

RabPoll RabBoard::poll(RabPacket& packet) {
    std::array<std::uint8_t, 1> number{kPop};
    std::array<std::uint8_t, 1> popped{};
    const std::array<I2cMessage, 2> ask{{{false, number}, {true, popped}}};
    if (!transfer(ask)) return RabPoll::Failed;
    if (popped[0] == 0) return RabPoll::Empty;
    std::array<std::uint8_t, 12> values{};
    if (!(settings_.burst ? read_burst(values) : read_singly(values))) return RabPoll::Failed;
    packet.payload = values[kData1 + 1];
    if (settings_.bytes > 1) packet.payload |= join(values[kData1], 0);
    if (settings_.bytes > 2) packet.payload |= join(0, values[kData3 + 1]) << 2 * kByteBits;
    if (settings_.bytes > 3) packet.payload |= join(values[kData3], 0) << 2 * kByteBits;
    const std::uint32_t bearing = join(values[kBearing], values[kBearing + 1]);
    packet.bearing = static_cast<std::int16_t>(bearing) * kBearingUnit;
    packet.strength = join(values[kStrength], values[kStrength + 1]);
    packet.time = clock_.now();
    return RabPoll::Message;
}

bool RabBoard::send_all(std::uint32_t payload) {
    Operation operation;
    store_high_bytes(operation, settings_.bytes, payload);
    operation.write({kSendAll, byte_of(payload, 0)});
    return transfer(operation.messages());
}

bool RabBoard::send_each(const std::array<std::optional<std::uint32_t>, kEmitters>& payloads) {
    bool alike = true;
    for (const auto& payload : payloads)
        alike = alike && payload && *payload == *payloads[0];
    if (alike) return send_all(*payloads[0]);
    Operation operation;
    for (std::uint8_t emitter = 0; emitter < kEmitters; ++emitter) {
        if (!payloads[emitter]) continue;
        store_high_bytes(operation, settings_.bytes, *payloads[emitter]);
        operation.write({emitter, byte_of(*payloads[emitter], 0)});
    }
    operation.write({kSendEach, 0});
    return transfer(operation.messages());
}

}  // namespace puckloop::control
