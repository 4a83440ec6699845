#include "emu/bluetooth/exchange.h"

#include "emu/bluetooth/module.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::bluetooth {

using cosim::Time;
using protocols::LmxPacket;

namespace {

constexpr Time kCharacter = 86'805'556;  // at 115200 baud
constexpr std::string_view kWord = "I hear you";

/// Two modules, a host at the first, and the word that comes out of the second.
class Bench {
  public:
    Bench(const Times& times, std::uint64_t seed)
        : network_(times, 10.0, seed, {}),
          sender_(options("sender", 1), network_),
          receiver_(options("receiver", 2), network_) {
        run(2 * cosim::kSecond);
        said_.clear();
        heard_.clear();
    }

    Time now() const { return now_; }
    const std::string& heard() const { return heard_; }

    void request(std::uint8_t opcode, const Bytes& data) {
        say(protocols::encode_lmx({protocols::kLmxRequest, opcode, data}));
    }
    void say(const Bytes& bytes) {
        for (const std::uint8_t byte : bytes) {
            run(kCharacter);
            sender_.byte_received(byte, now_);
        }
    }
    void say_break() {
        run(kCharacter);
        sender_.break_received(now_);
    }
    /// The next packet with this opcode of type confirm or indication; nothing within `patience`.
    std::optional<LmxPacket> await(std::uint8_t type, std::uint8_t opcode, std::vector<LmxPacket>* others,
                                   Time patience = 60 * cosim::kSecond) {
        const Time until = now_ + patience;
        for (;;) {
            while (!said_.empty()) {
                const LmxPacket packet = said_.front();
                said_.erase(said_.begin());
                if (packet.type == type && packet.opcode == opcode) return packet;
                if (others != nullptr) others->push_back(packet);
            }
            if (now_ >= until || !step(until)) return std::nullopt;
        }
    }
    /// Passes time.
    void run(Time time) {
        const Time until = now_ + time;
        while (step(until)) {
        }
        now_ = until;
    }

  private:
    static ModuleOptions options(const char* name, std::uint8_t number) {
        ModuleOptions options;
        options.name = name;
        options.settings.name = "e-puck_000" + std::to_string(number);
        options.settings.pin = "000" + std::to_string(number);
        options.settings.address = {number, 0, 0x2C, 0x17, 0x00, 0x08};
        return options;
    }

    /// The next thing that happens by `until`, if any.
    bool step(Time until) {
        SerialOut* line =
            sender_.serial().next() <= receiver_.serial().next() ? &sender_.serial() : &receiver_.serial();
        const Time byte = line->next(), event = network_.agenda().next();
        if (std::min(byte, event) > until) return false;
        now_ = std::max(now_, std::min(byte, event));
        if (event <= byte) {
            network_.step();
            return true;
        }
        const cosim::UartFrame frame = line->take();
        const auto octet = static_cast<std::uint8_t>(frame.data);
        if (frame.is_break != 0) return true;
        if (line == &receiver_.serial()) {
            // The word, and no packets: those begin with 02 and are over before it.
            const auto reading = receiver_reader_.take(octet);
            if (!reading && receiver_reader_.idle()) heard_ += static_cast<char>(octet);
        } else if (const auto reading = reader_.take(octet); reading && reading->ok()) {
            now_ = std::max(now_, frame.start + kCharacter);
            said_.push_back(reading->packet);
        }
        return true;
    }

    Network network_;
    Module sender_, receiver_;
    protocols::LmxReader reader_, receiver_reader_;
    std::vector<LmxPacket> said_;
    std::string heard_;
    Time now_ = 0;
};

double seconds_since(Time since, Time now) {
    return cosim::to_seconds(now - since);
}

Bytes text_with_length(std::string_view text) {
    Bytes data{static_cast<std::uint8_t>(text.size())};
    std::copy(text.begin(), text.end(), std::back_inserter(data));
    return data;
}

}  // namespace

Exchange exchange(const Times& times, std::uint64_t seed, std::uint64_t number) {
    using protocols::kLmxConfirm, protocols::kLmxIndication;
    Bench bench(times, RandomStream(seed, "exchange " + std::to_string(number)).next());
    Exchange result;
    const Time begin = bench.now();
    const auto fail = [&] {
        result.total = seconds_since(begin, bench.now());
        return result;
    };
    bench.request(0x16, {});
    bench.await(kLmxConfirm, 0x16, nullptr);
    Time since = bench.now();
    std::vector<LmxPacket> devices;
    bench.request(0x00, {5, 10, 0});
    bench.await(kLmxConfirm, 0x00, &devices);
    result.inquiry = seconds_since(since, bench.now());
    if (devices.empty()) return fail();
    result.found = true;
    const Bytes address(devices.front().data.begin(), devices.front().data.begin() + 6);
    since = bench.now();
    bench.request(0x02, address);
    const auto named = bench.await(kLmxConfirm, 0x02, nullptr);
    result.name = seconds_since(since, bench.now());
    constexpr std::size_t kName = 8, kNumber = 7;  // in the confirm, in the name
    if (!named || named->data.size() < kName + kNumber + 4 || named->data[0] != 0) return fail();
    const auto digits = named->data.begin() + kName + kNumber;
    bench.request(0x17, text_with_length(std::string(digits, digits + 4)));
    bench.await(kLmxConfirm, 0x17, nullptr);
    since = bench.now();
    Bytes wanted{1};
    std::copy(address.begin(), address.end(), std::back_inserter(wanted));
    wanted.push_back(1);
    bench.request(0x0A, wanted);
    const auto linked = bench.await(kLmxIndication, 0x0B, nullptr);
    result.link = seconds_since(since, bench.now());
    bench.request(0x17, text_with_length("0001"));
    bench.await(kLmxConfirm, 0x17, nullptr);
    if (!linked || linked->data[0] != kRfcommOk) return fail();
    result.linked = true;
    bench.request(0x11, {1});
    bench.await(kLmxConfirm, 0x11, nullptr);
    bench.say(Bytes(kWord.begin(), kWord.end()));
    bench.run(100 * cosim::kMillisecond);
    result.arrived = bench.heard() == kWord;
    bench.say_break();
    bench.await(kLmxIndication, 0x11, nullptr);
    since = bench.now();
    bench.request(0x0D, {1});
    bench.await(kLmxIndication, 0x0E, nullptr);
    result.release = seconds_since(since, bench.now());
    result.total = seconds_since(begin, bench.now());
    return result;
}

}  // namespace puckloop::bluetooth
