#pragma once
// An XBee module and a set of TAMs behind it, as far as a coordinator can see: bytes in, bytes out, each at
// its time. Written from the fact sheet of the TAM, not from the coordinator.

#include "base/random.h"
#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace puckloop::coordinator::test {

inline constexpr double kByte = 10.0 / 9600;  // s

struct SimulatedTam {
    std::string name;
    std::uint64_t address = 0;
    bool alive = true;
    std::uint8_t red = 0, green = 0, blue = 0;
    bool robot = false;
    std::uint8_t heard = 0;    ///< from robots
    std::uint8_t written = 0;  ///< for robots
    bool off = false;          ///< was switched off
    std::vector<double> set_leds_at;
    double next_report = 0;
};

class SimulatedMesh {
  public:
    struct Settings {
        double latency = 0.02;  ///< s, radio and firmware, at least; up to four times as much
        double loss = 0;        ///< of a radio packet, 0..1
        double noise = 0;       ///< of a byte of garbage between two frames to the host
        std::uint8_t api_mode = 2;
        std::uint8_t window = 4;  ///< NT, 100 ms
        bool answers = true;
        std::uint64_t seed = 1;
    };

    explicit SimulatedMesh(Settings settings) : settings_(settings), random_(settings.seed, "mesh") {}

    SimulatedTam& add(std::string name, std::uint64_t address, double boots_at = 0);
    /// A byte of the host.
    void take(std::uint8_t byte, double now);
    /// Bytes to the host that are due.
    std::vector<std::uint8_t> give(double now);
    /// When give() or something planned is next due; a time far away if nothing is.
    double next() const;
    /// `action` happens at `time`.
    void plan(double time, std::function<void()> action) { planned_.emplace(time, std::move(action)); }
    void set_robot(SimulatedTam& tam, bool inside, double now);
    /// Raw bytes for the host.
    void send_raw(const std::vector<std::uint8_t>& bytes, double now);

    std::map<std::string, SimulatedTam> tams;
    std::vector<std::string> commands;  ///< AT commands of the host, as they came
    int bad_frames = 0;                 ///< of the host

  private:
    void take_message(const protocols::XBeeMessage& message, double now);
    void take_at(const protocols::XBeeAt& command, double now);
    void take_packet(const protocols::XBeeTx& packet, double now);
    void send(const protocols::XBeeMessage& message, double now);
    void report(SimulatedTam& tam, double now, int tries = 10);
    double delay() { return settings_.latency * (1 + 3 * random_.uniform()); }
    bool lost() { return random_.uniform() < settings_.loss; }

    Settings settings_;
    RandomStream random_;
    protocols::XBeeReader reader_{protocols::XBeeApiMode::Escaped};
    std::multimap<double, std::function<void()>> planned_;
    std::vector<std::pair<double, std::uint8_t>> out_;
    double line_free_ = 0;
};

}  // namespace puckloop::coordinator::test
