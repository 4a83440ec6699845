#include "tests/coordinator/simulated_mesh.h"

#include <algorithm>

namespace puckloop::coordinator::test {

using namespace protocols;

namespace {

constexpr double kFar = 1e12;
constexpr double kHeartbeat = 10, kRepeat = 1;  // s

void put(XBeeBytes& bytes, std::uint64_t value, int count) {
    for (int i = count - 1; i >= 0; --i)
        bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

}  // namespace

SimulatedTam& SimulatedMesh::add(std::string name, std::uint64_t address, double boots_at) {
    SimulatedTam& tam = tams[name];
    tam.name = std::move(name);
    tam.address = address;
    tam.alive = boots_at <= 0;
    // Heartbeats: the plan goes on for ever.
    struct Beat {
        SimulatedMesh& mesh;
        SimulatedTam& tam;
        void at(double time) {
            mesh.plan(time, [*this, time]() mutable {
                tam.alive = tam.alive || time > 0;
                mesh.report(tam, time, 1);
                at(time + kHeartbeat);
            });
        }
    };
    if (boots_at > 0) plan(boots_at, [&tam] { tam.alive = true; });
    Beat{*this, tam}.at(boots_at + kHeartbeat * (0.5 + random_.uniform()));
    return tam;
}

void SimulatedMesh::take(std::uint8_t byte, double now) {
    const auto reading = reader_.take(byte);
    if (!reading) return;
    if (!reading->ok()) {
        ++bad_frames;
        return;
    }
    take_message(decode_xbee(reading->data), now);
}

void SimulatedMesh::take_message(const XBeeMessage& message, double now) {
    if (const auto* command = std::get_if<XBeeAt>(&message)) take_at(*command, now);
    if (const auto* packet = std::get_if<XBeeTx>(&message)) take_packet(*packet, now);
}

void SimulatedMesh::take_at(const XBeeAt& command, double now) {
    const std::string name(command.command.begin(), command.command.end());
    commands.push_back(name);
    if (!settings_.answers) return;
    XBeeAtResponse response{.id = command.id, .command = command.command, .value = {}};
    if (name == "AP" && !command.value.empty())
        settings_.api_mode = command.value[0];
    else if (name == "AP")
        response.value = {settings_.api_mode};
    else if (name == "HV")
        response.value = {0x17, 0x44};
    else if (name == "VR")
        response.value = {0x80, 0x73};
    else if (name == "NT")
        response.value = {0, settings_.window};
    else if (name == "DB")
        response.value = {0x28};
    else if (name == "ND") {
        for (auto& [id, tam] : tams) {
            if (!tam.alive || tam.off || lost()) continue;
            XBeeAtResponse found = response;
            found.status = 0x40;  // as the modules say it
            put(found.value, 0xFFFE, 2);
            put(found.value, tam.address, 8);
            found.value.insert(found.value.end(), tam.name.begin(), tam.name.end());
            found.value.push_back(0);
            put(found.value, 0xFFFE, 2);
            found.value.push_back(0);
            const double at = now + 0.1 * settings_.window * random_.uniform();
            plan(at, [this, found, at] { send(found, at); });
        }
        return;
    } else {
        response.status = 2;
    }
    send(response, now + 0.002);
}

void SimulatedMesh::take_packet(const XBeeTx& packet, double now) {
    SimulatedTam* tam = nullptr;
    for (auto& [id, other] : tams)
        if (other.address == packet.to && other.alive && !other.off) tam = &other;
    const bool arrives = tam != nullptr && !lost();
    const double at = now + delay();
    const XBeeTxStatus status{.id = packet.id, .delivery = static_cast<std::uint8_t>(arrives ? 0 : 0x24)};
    plan(at, [this, status, at] { send(status, at); });
    if (!arrives || packet.data.empty()) return;
    plan(at, [this, tam, at, data = packet.data] {
        if (data[0] == 0x0A && data.size() == 4) {
            tam->red = data[1], tam->green = data[2], tam->blue = data[3];
            tam->set_leds_at.push_back(at);
            report(*tam, at + delay());
        } else if (data[0] == 0x0C && data.size() == 2) {
            tam->written = data[1];
        } else if (data[0] == 0x0D) {
            tam->off = true;
        }
    });
}

/// The TAM reports now; without acknowledgement again after a second.
void SimulatedMesh::report(SimulatedTam& tam, double now, int tries) {
    plan(now, [this, &tam, now, tries] {
        if (!tam.alive || tam.off) return;
        if (lost()) {
            if (tries > 1) report(tam, now + kRepeat, tries - 1);
            return;
        }
        XBeeRx packet{.from = tam.address, .options = 1, .data = {}};
        packet.data = {0,    tam.red, tam.green, tam.blue, static_cast<std::uint8_t>(tam.robot),
                       0xD3, 0x0E,    tam.heard};
        const double at = now + delay();
        plan(at, [this, packet, at] { send(packet, at); });
    });
}

void SimulatedMesh::set_robot(SimulatedTam& tam, bool inside, double now) {
    if (tam.robot == inside) return;
    tam.robot = inside;
    report(tam, now + 0.386);
}

void SimulatedMesh::send(const XBeeMessage& message, double now) {
    std::vector<std::uint8_t> bytes;
    if (random_.uniform() < settings_.noise) bytes.push_back(static_cast<std::uint8_t>(random_.below(0x7E)));
    const std::vector<std::uint8_t> frame = encode_xbee(encode(message), XBeeApiMode::Escaped);
    bytes.insert(bytes.end(), frame.begin(), frame.end());
    send_raw(bytes, now);
}

void SimulatedMesh::send_raw(const std::vector<std::uint8_t>& bytes, double now) {
    line_free_ = std::max(line_free_, now);
    for (const std::uint8_t byte : bytes)
        out_.emplace_back(line_free_ += kByte, byte);
}

std::vector<std::uint8_t> SimulatedMesh::give(double now) {
    while (!planned_.empty() && planned_.begin()->first <= now) {
        const std::function<void()> action = std::move(planned_.begin()->second);
        planned_.erase(planned_.begin());
        action();
    }
    std::vector<std::uint8_t> bytes;
    std::size_t count = 0;
    while (count < out_.size() && out_[count].first <= now)
        bytes.push_back(out_[count++].second);
    out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(count));
    return bytes;
}

double SimulatedMesh::next() const {
    const double planned = planned_.empty() ? kFar : planned_.begin()->first;
    return out_.empty() ? planned : std::min(planned, out_.front().first);
}

}  // namespace puckloop::coordinator::test
