#pragma once
// Robots and booths with IRcom's medium between them, advanced in steps of the medium's delay. Robots are
// whole boards with an image, spoken to by UART2 as a Linux board would; booths are tests/tam_board's.

#include "emu/pic/pic_node.h"
#include "physics/ircom/ircom_node.h"
#include "protocols/infrared/ircom.h"
#include "protocols/serial/epuck_serial.h"
#include "tests/ircom/worlds.h"
#include "tests/tam_board/booth.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::ircom_test {

using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::kSecond;

inline std::string image_path(const std::string& name) {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    if (!folder) return {};
    const std::string path = std::string(folder) + "/" + name;
    return std::filesystem::exists(path) ? path : std::string{};
}

inline physics::IrcomIds board_ids() {
    physics::IrcomIds ids;
    for (std::size_t i = 0; i < ids.pulse.size(); ++i)
        ids.pulse[i] = static_cast<std::uint16_t>(pic::kPulse + i);
    for (std::size_t i = 0; i < ids.light.size(); ++i)
        ids.light[i] = static_cast<std::uint16_t>(pic::kInfraredLight + i);
    ids.emit = tam::kProximityEmit;
    ids.sense = tam::kProximitySense;
    return ids;
}

/// A main board, and what its Linux board would see.
class Robot {
  public:
    Robot(const std::string& name, const std::string& image, double crystal_ppm = 0.0, double noise = 2.0)
        : node(std::make_unique<pic::PicNode>(image::load_image(image), options(name, crystal_ppm, noise))) {}

    /// Bytes on the line, one behind the other, from `now` on.
    void send(Time now, const std::vector<std::uint8_t>& bytes) {
        line_free_ = std::max(line_free_, now);
        for (const std::uint8_t byte : bytes) {
            cosim::UartFrame frame;
            frame.start = line_free_;
            frame.bit_period = kBit;
            frame.data = byte;
            line_free_ += 10 * kBit;
            inbox.push_back({frame.start + 9 * kBit, pic::PicNode::kUart2, frame});
        }
    }
    template <typename Record>
    void send_record(Time now, const Record& record) {
        const auto bytes = protocols::encode(record);
        send(now, {bytes.begin(), bytes.end()});
    }
    void send_word(Time now, int word) {
        protocols::EpuckActuators record;
        record.reset = 'N';
        if (word >= 0) {
            record.ircom_enabled = 1;
            record.ircom_data = static_cast<std::uint8_t>(word);
        }
        send_record(now, record);
    }

    std::unique_ptr<pic::PicNode> node;
    std::vector<Message> inbox;  ///< to come
    std::vector<std::uint8_t> received;

  private:
    static constexpr Time kBit = kSecond / 115200;
    static pic::PicNodeOptions options(const std::string& name, double ppm, double noise) {
        pic::PicNodeOptions options;
        options.board.name = name;
        options.board.crystal_ppm = ppm;
        options.board.adc_noise_counts = noise;
        options.ircom = true;
        options.i2c_linked = false;
        return options;
    }
    Time line_free_ = 0;
};

class Air {
  public:
    explicit Air(const physics::World& description, const std::string& words = "")
        : medium(description, {"ircom", board_ids(), words, false}) {}

    /// In the description's order, booths after robots. Booths began `booth_offset` later than robots.
    std::vector<Robot*> robots;
    std::vector<tam::test::Booth*> booths;
    Time booth_offset = 0;
    physics::IrcomNode medium;
    Time now = 0;

    /// Boots everything without light between: to `time`.
    void boot(Time time) {
        std::vector<Message> dropped;
        for (Robot* robot : robots)
            robot->node->advance(time, {}, dropped);
        for (tam::test::Booth* booth : booths) {
            booth->run_until(time - booth_offset);
            emits_seen_.push_back(booth->rig.changes.size());
        }
        medium.advance(time, {}, dropped);
        now = time;
        to_booth_.resize(booths.size());
    }

    void run_until(Time until) {
        while (now < until)
            step(std::min(until, now + kStep));
    }
    void run_for(Time time) { run_until(now + time); }

  private:
    static constexpr Time kStep = 20 * kMicrosecond;

    void step(Time next) {
        std::vector<Message> light, out;
        for (std::size_t r = 0; r < robots.size(); ++r) {
            Robot& robot = *robots[r];
            std::stable_sort(robot.inbox.begin(), robot.inbox.end(), earlier);
            const auto due = std::find_if(robot.inbox.begin(), robot.inbox.end(),
                                          [&](const Message& m) { return m.time >= next; });
            out.clear();
            robot.node->advance(
                next, std::span(robot.inbox.data(), static_cast<std::size_t>(due - robot.inbox.begin())),
                out);
            robot.inbox.erase(robot.inbox.begin(), due);
            for (const Message& message : out) {
                if (message.port == pic::PicNode::kIr)
                    light.push_back({message.time, static_cast<PortIndex>(r), message.payload});
                if (message.port == pic::PicNode::kUart2)
                    robot.received.push_back(
                        static_cast<std::uint8_t>(std::get<cosim::UartFrame>(message.payload).data));
            }
        }
        for (std::size_t b = 0; b < booths.size(); ++b) {
            tam::test::Booth& booth = *booths[b];
            auto& inbox = to_booth_[b];
            while (!inbox.empty() && inbox.front().time < next) {
                booth.run_until(inbox.front().time - booth_offset);
                booth.rig.board.set_signal(tam::kProximitySense,
                                           std::get<Signal>(inbox.front().payload).value);
                inbox.erase(inbox.begin());
            }
            booth.run_until(next - booth_offset);
            for (; emits_seen_[b] < booth.rig.changes.size(); ++emits_seen_[b]) {
                const auto& change = booth.rig.changes[emits_seen_[b]];
                if (change.id != tam::kProximityEmit) continue;
                light.push_back({change.at + booth_offset, static_cast<PortIndex>(robots.size() + b),
                                 Signal{change.id, change.value}});
            }
        }
        std::stable_sort(light.begin(), light.end(), earlier);
        out.clear();
        medium.advance(next, light, out);
        for (const Message& message : out) {
            REQUIRE(message.time >= now);
            if (message.port < robots.size())
                robots[message.port]->inbox.push_back({message.time, pic::PicNode::kIr, message.payload});
            else
                to_booth_[message.port - robots.size()].push_back(message);
        }
        now = next;
    }
    static bool earlier(const Message& a, const Message& b) { return a.time < b.time; }

    std::vector<std::size_t> emits_seen_;
    std::vector<std::vector<Message>> to_booth_;
};

}  // namespace puckloop::ircom_test
