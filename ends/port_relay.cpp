#include "ends/port_relay.h"

#include "base/error.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include <array>
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

constexpr std::size_t kRelayBlock = 16 * 1024;  // octets that wait in one direction at most

class Relayed : public std::enable_shared_from_this<Relayed> {
  public:
    Relayed(tcp::socket outer, boost::asio::io_context& io) : outer_(std::move(outer)), inner_(io) {}

    void begin(const std::string& path) {
        auto self = shared_from_this();
        inner_.async_connect(Local::endpoint(path), [self](const error_code& error) {
            if (error) return self->close();  // the run is not yet there, or over
            self->pass(self->outer_, self->inner_, self->in_);
            self->pass(self->inner_, self->outer_, self->out_);
        });
    }

  private:
    using Block = std::array<char, kRelayBlock>;

    template <class From, class To>
    void pass(From& from, To& to, Block& block) {
        auto self = shared_from_this();
        from.async_read_some(boost::asio::buffer(block), [self, &from, &to, &block](const error_code& error,
                                                                                    std::size_t size) {
            if (error) return self->ended(to, error);
            boost::asio::async_write(to, boost::asio::buffer(block, size),
                                     [self, &from, &to, &block](const error_code& failed, std::size_t) {
                                         if (failed) return self->close();
                                         self->pass(from, to, block);
                                     });
        });
    }
    template <class To>
    void ended(To& to, const error_code& error) {
        if (error != boost::asio::error::eof) return close();
        error_code ignored;
        to.shutdown(To::shutdown_send, ignored);
    }
    void close() {
        error_code ignored;
        outer_.close(ignored);
        inner_.close(ignored);
    }

    tcp::socket outer_;
    Local::socket inner_;
    Block in_{}, out_{};
};

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
                std::make_shared<Relayed>(std::move(caller), io)->begin(door.socket);
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
