#include "ends/port_relay.h"

#include "base/error.h"
#include "base/relay/octet_relay.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <list>
#include <memory>
#include <thread>
#include <utility>

namespace puckloop::exec {

namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;
using Local = boost::asio::local::stream_protocol;

using Relayed = OctetRelay<tcp::socket, Local::socket>;

/// To the socket at `path`; a caller whom nobody answers there (the run is not yet there, or over) is left.
void relay(tcp::socket caller, const std::string& path, boost::asio::io_context& io) {
    auto relayed = std::make_shared<Relayed>(std::move(caller), Local::socket(io));
    relayed->second().async_connect(Local::endpoint(path), [relayed](const error_code& error) {
        if (!error) relayed->begin();
    });
}

}  // namespace

struct PortRelay::Parts {
    struct Door {
        tcp::acceptor acceptor;
        std::string socket;
    };

    void open(const RelayedPort& port) {
        Door& door = doors.emplace_back(Door{tcp::acceptor(io), port.socket});
        try {
            const tcp::endpoint here(boost::asio::ip::address_v4::loopback(), port.port);
            door.acceptor.open(here.protocol());
            door.acceptor.set_option(tcp::acceptor::reuse_address(true));
            door.acceptor.bind(here);
            door.acceptor.listen();
        } catch (const boost::system::system_error& error) {
            throw InputError("", fmt::format("--join: port {}", port.port), error.code().message(),
                             "a free port");
        }
        accept(door);
    }
    void accept(Door& door) {
        door.acceptor.async_accept([this, &door](const error_code& error, tcp::socket caller) {
            if (error == boost::asio::error::operation_aborted) return;
            if (!error) {
                error_code ignored;
                caller.set_option(tcp::no_delay(true), ignored);
                relay(std::move(caller), door.socket, io);
            }
            accept(door);
        });
    }

    boost::asio::io_context io;
    std::list<Door> doors;
    std::thread thread;
};

PortRelay::PortRelay(const std::vector<RelayedPort>& ports) : parts_(std::make_unique<Parts>()) {
    for (const RelayedPort& port : ports)
        parts_->open(port);
    parts_->thread = std::thread([io = &parts_->io] { io->run(); });
}

PortRelay::~PortRelay() {
    parts_->io.stop();
    parts_->thread.join();
    std::error_code ignored;
    for (const Parts::Door& door : parts_->doors)
        std::filesystem::remove(door.socket, ignored);
}

}  // namespace puckloop::exec
