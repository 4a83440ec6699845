// What a module answers to requests about links.

#include "emu/bluetooth/module.h"

#include <algorithm>
#include <iterator>

namespace puckloop::bluetooth {

using cosim::Time;

namespace {

constexpr std::uint8_t kBadState = 0x13, kLimit = 0x1B, kBadPort = 0x20, kBusy = 0x22, kSeveral = 0x23,
                       kNotStored = 0x25;
constexpr std::uint8_t kAll = 0xFF;

}  // namespace

void Module::establish(const Bytes& data, Time now) {
    const std::uint8_t port = data[0], remote_port = data[7];
    if (port < 1 || port > kPorts || remote_port < 1 || remote_port > kPorts)
        return refuse_port(kBadPort, port, now);
    if (links_.contains(port)) return refuse_port(kBusy, port, now);
    if (links_.size() >= kMostLinks) return refuse_port(kLimit, port, now);
    Address peer{};
    std::copy_n(data.begin() + 1, peer.size(), peer.begin());
    links_[port] = {0, peer, remote_port};
    confirm(asked_, {kOk, port}, now);
    network_.connect(number_, peer, port, remote_port, now);
}

void Module::release(const Bytes& data, Time now) {
    const auto open = links_.find(data[0]);
    if (open == links_.end() || open->second.link == 0) return refuse_port(kNoConnection, data[0], now);
    confirm(asked_, {kOk, data[0]}, now);
    network_.release(number_, open->second.link, now);
}

void Module::send_data(const Bytes& data, Time now) {
    constexpr std::size_t kHeader = 3;
    if (data.size() < kHeader || data.size() - kHeader != (data[1] | std::size_t{data[2]} << 8))
        return refuse_port(kBadCount, data.empty() ? 0 : data[0], now);
    if (data.size() - kHeader > kMostPayload) return refuse_port(kLimit, data[0], now);
    const auto open = links_.find(data[0]);
    if (open == links_.end() || open->second.link == 0) return refuse_port(kNoConnection, data[0], now);
    confirm(asked_, {kOk, data[0]}, now);
    if (data.size() > kHeader)
        network_.send(number_, open->second.link, Bytes(data.begin() + kHeader, data.end()), now);
}

void Module::go_transparent(const Bytes& data, Time now) {
    const auto open = links_.find(data[0]);
    if (open == links_.end() || open->second.link == 0) return refuse_port(kNoConnection, data[0], now);
    if (links_.size() > 1) return refuse_port(kSeveral, data[0], now);
    confirm(asked_, {kOk, data[0]}, now);
    transparent_ = data[0];
}

void Module::dial_default(const Bytes& data, Time now) {
    if (settings_.defaults.empty() || (data[0] != kAll && data[0] >= settings_.defaults.size()))
        return status(kNotStored, now);
    status(kOk, now);
    for (std::size_t i = 0; i < settings_.defaults.size(); ++i)
        if (data[0] == kAll || data[0] == i) dial(settings_.defaults[i], now);
}

void Module::store_default(const Bytes& data, Time now) {
    if (data[0] > 1) return status(kBadState, now);
    if (data[1] < 1 || data[1] > kPorts || data[8] < 1 || data[8] > kPorts) return status(kBadPort, now);
    if (settings_.defaults.size() >= kMostDefaults) return status(kLimit, now);
    constexpr std::uint8_t kMultiple = 0x24;
    for (const DefaultConnection& stored : settings_.defaults)
        if (stored.transparent || data[0] == 1) return status(kMultiple, now);
    DefaultConnection connection;
    connection.transparent = data[0] == 1;
    connection.port = data[1];
    std::copy_n(data.begin() + 2, connection.address.size(), connection.address.begin());
    connection.remote_port = data[8];
    settings_.defaults.push_back(connection);
    status(kOk, now);
}

void Module::list_defaults(const Bytes&, Time now) {
    Bytes answer{kOk, static_cast<std::uint8_t>(settings_.defaults.size())};
    for (const DefaultConnection& stored : settings_.defaults) {
        answer.push_back(stored.transparent ? 1 : 0);
        answer.push_back(stored.port);
        std::copy(stored.address.begin(), stored.address.end(), std::back_inserter(answer));
        answer.push_back(stored.remote_port);
    }
    confirm(asked_, answer, now);
}

void Module::delete_default(const Bytes& data, Time now) {
    if (data[0] != kAll && data[0] >= settings_.defaults.size()) return status(kNotStored, now);
    if (data[0] == kAll)
        settings_.defaults.clear();
    else
        settings_.defaults.erase(settings_.defaults.begin() + data[0]);
    status(kOk, now);
}

}  // namespace puckloop::bluetooth
