// puckloop-gate PATH=HOST:PORT...: whoever connects with a socket at PATH, in the host's file system, is
// connected with HOST:PORT in the emulated network. Started by `puckloop run --join` (docs/network.md).
//
// Exit status: 2 wrong use, or a socket that cannot be made.

#include "base/relay/octet_relay.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include <cstdio>
#include <cstdlib>
#include <list>
#include <memory>
#include <string>
#include <utility>

namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;
using Local = boost::asio::local::stream_protocol;

constexpr int kWrongUse = 2;
constexpr std::size_t kMostCallers = 256;

[[noreturn]] void refuse(const std::string& what) {
    std::fprintf(stderr, "puckloop-gate: %s\n", what.c_str());
    std::exit(kWrongUse);
}

std::size_t callers = 0;

class Caller : public puckloop::OctetRelay<Local::socket, tcp::socket> {
  public:
    Caller(Local::socket outer, boost::asio::io_context& io) : OctetRelay(std::move(outer), tcp::socket(io)) {
        ++callers;
    }
    ~Caller() { --callers; }
    Caller(const Caller&) = delete;
    Caller& operator=(const Caller&) = delete;
};

struct Door {
    std::string host, port;
    Local::acceptor acceptor;
};

void report(const Door& door, const error_code& error) {
    std::printf("%s:%s: %s\n", door.host.c_str(), door.port.c_str(), error.message().c_str());
}

void welcome(const Door& door, Local::socket outer, boost::asio::io_context& io) {
    if (callers >= kMostCallers) return;
    error_code error;
    const auto found = tcp::resolver(io).resolve(tcp::v4(), door.host, door.port, error);
    if (error) return report(door, error);
    auto caller = std::make_shared<Caller>(std::move(outer), io);
    caller->second().async_connect(found.begin()->endpoint(), [caller, &door](const error_code& failed) {
        if (failed) return report(door, failed);
        caller->begin();
    });
}

void accept(Door& door, boost::asio::io_context& io) {
    door.acceptor.async_accept([&door, &io](const error_code& error, Local::socket outer) {
        if (!error) welcome(door, std::move(outer), io);
        accept(door, io);
    });
}

Door open_door(const std::string& text, boost::asio::io_context& io) {
    const std::size_t equals = text.find('='), colon = text.rfind(':');
    if (equals == std::string::npos || colon == std::string::npos || colon < equals)
        refuse("'" + text + "' is not PATH=HOST:PORT");
    const std::string path = text.substr(0, equals);
    try {
        return {text.substr(equals + 1, colon - equals - 1), text.substr(colon + 1),
                Local::acceptor(io, Local::endpoint(path))};
    } catch (const boost::system::system_error& error) {
        refuse(path + ": " + error.code().message());
    }
}

}  // namespace

int main(int count, char** words) {
    if (count < 2) refuse("usage: puckloop-gate PATH=HOST:PORT...");
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    boost::asio::io_context io;
    std::list<Door> doors;
    for (int i = 1; i < count; ++i) {
        doors.push_back(open_door(words[i], io));
        accept(doors.back(), io);
    }
    io.run();
}
