// `--uartN tcp:PORT`: one client at a time, on 127.0.0.1 only.

#include "base/error.h"
#include "tools/exec/ends/queued_end.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <fmt/format.h>

namespace puckloop::exec {

namespace {

using boost::asio::ip::tcp;

/// What a client that does not read may leave waiting.
constexpr std::size_t kLongestBacklog = 1 << 20;

class TcpEnd : public QueuedEnd {
  public:
    explicit TcpEnd(std::uint16_t port) : acceptor_(io_), client_(io_) {
        try {
            const tcp::endpoint here(boost::asio::ip::address_v4::loopback(), port);
            acceptor_.open(here.protocol());
            acceptor_.set_option(tcp::acceptor::reuse_address(true));
            acceptor_.bind(here);
            acceptor_.listen();
            acceptor_.non_blocking(true);
        } catch (const boost::system::system_error& error) {
            throw InputError("", fmt::format("tcp:{}", port), error.code().message(), "a free port");
        }
    }

    void receive(std::uint8_t byte, bool clean, cosim::Time start) override {
        if (client_.is_open() && outgoing_.size() < kLongestBacklog) QueuedEnd::receive(byte, clean, start);
    }
    bool live() const override { return true; }
    std::string announcement() const override {
        return fmt::format("tcp 127.0.0.1:{}", acceptor_.local_endpoint().port());
    }
    void finish() override {
        write_out();
        drop_client();
    }

    void poll(cosim::Time now, cosim::Time /*listening_since*/) override {
        accept();
        write_out();
        if (!client_.is_open() || waiting()) return;
        std::uint8_t block[512];
        boost::system::error_code error;
        const std::size_t got = client_.read_some(boost::asio::buffer(block), error);
        offer(block, got, now);
        if (error && error != boost::asio::error::would_block) drop_client();
    }

  private:
    void accept() {
        tcp::socket caller(io_);
        boost::system::error_code error;
        acceptor_.accept(caller, error);
        if (error || client_.is_open()) return;  // a second caller is hung up on
        client_ = std::move(caller);
        client_.non_blocking(true, error);
        client_.set_option(tcp::no_delay(true), error);
    }
    void write_out() {
        if (!client_.is_open() || outgoing_.empty()) return;
        boost::system::error_code error;
        outgoing_.erase(0, client_.write_some(boost::asio::buffer(outgoing_), error));
        if (error && error != boost::asio::error::would_block) drop_client();
    }
    void drop_client() {
        boost::system::error_code ignored;
        client_.shutdown(tcp::socket::shutdown_both, ignored);
        client_.close(ignored);
        outgoing_.clear();
    }

    boost::asio::io_context io_;
    tcp::acceptor acceptor_;
    tcp::socket client_;
};

}  // namespace

std::unique_ptr<UartEnd> make_tcp_end(std::uint16_t port) {
    return std::make_unique<TcpEnd>(port);
}

}  // namespace puckloop::exec
