#include "benchmark/speeds/rab_speed.h"

#include "emu/image/image.h"
#include "emu/rab_board/rab_node.h"

#include <chrono>
#include <string_view>
#include <vector>

namespace puckloop::tools {

namespace {

using cosim::Time;

constexpr Time kRabStartUp = 100 * cosim::kMillisecond;
constexpr Time kSlice = 10 * cosim::kMillisecond;
constexpr Time kBit = cosim::kSecond / 57'600;
constexpr std::string_view kCommand = "A5C3";  // four hexadecimal digits: send them

/// The command's characters, from `time` on; each is a message when its stop bit begins.
std::vector<cosim::Message> command(Time time) {
    constexpr int kBitsBeforeStop = 9;
    constexpr int kBits = 10;
    std::vector<cosim::Message> messages;
    for (const char c : kCommand) {
        cosim::UartFrame frame;
        frame.start = time;
        frame.bit_period = kBit;
        frame.data = static_cast<std::uint8_t>(c);
        messages.push_back({time + kBitsBeforeStop * kBit, rab::RabNode::kUart2, frame});
        time += kBits * kBit;
    }
    return messages;
}

}  // namespace

double rab_board_speed(const std::filesystem::path& image, RabWork work, double wall_s) {
    using Clock = std::chrono::steady_clock;
    rab::RabNode node(image::load_image(image.string()), {});
    std::vector<cosim::Message> outbox;
    node.advance(kRabStartUp, {}, outbox);
    const auto start = Clock::now();
    Time now = kRabStartUp;
    double elapsed = 0;
    do {
        const std::vector<cosim::Message> inbox =
            work == RabWork::Sending ? command(now) : std::vector<cosim::Message>{};
        outbox.clear();
        now += kSlice;
        node.advance(now, inbox, outbox);
        elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    } while (elapsed < wall_s);
    return cosim::to_seconds(now - kRabStartUp) / elapsed;
}

}  // namespace puckloop::tools
