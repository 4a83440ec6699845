// `--uartN tcp:PORT`: one client at a time, on 127.0.0.1 only.

#include "base/error.h"
#include "ends/live_end.h"

#include <boost/asio/ip/tcp.hpp>
#include <fmt/format.h>

#include <atomic>
#include <utility>

namespace puckloop::exec {

namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

/// Of the kernel's own for a client, as small as a serial driver's: what waits is to be known here.
constexpr int kSendBuffer = 64 << 10;

class TcpClient final : public HostStream {
  public:
    TcpClient(boost::asio::io_context& io, const std::string& name, std::uint16_t port)
        : acceptor_(io), client_(io) {
        try {
            const tcp::endpoint here(boost::asio::ip::address_v4::loopback(), port);
            acceptor_.open(here.protocol());
            acceptor_.set_option(tcp::acceptor::reuse_address(true));
            acceptor_.bind(here);
            acceptor_.listen();
        } catch (const boost::system::system_error& error) {
            throw InputError("", fmt::format("{}: tcp:{}", name, port), error.code().message(),
                             "a free port");
        }
        port_ = acceptor_.local_endpoint().port();
        accept();
    }
    ~TcpClient() override { drop(); }

    std::string announcement() const override { return fmt::format("tcp 127.0.0.1:{}", port_); }
    bool there() const override { return there_; }

    void await_readable(std::function<void()> then) override {
        then_ = std::move(then);
        await();
    }
    std::size_t read(std::span<std::uint8_t> block) override {
        if (!client_.is_open()) return 0;
        error_code error;
        const std::size_t got = client_.read_some(boost::asio::buffer(block.data(), block.size()), error);
        if (error == boost::asio::error::eof)
            sends_no_more_ = true;  // it may still read, as behind `printf 'V\r' | nc`
        else if (error && error != boost::asio::error::would_block)
            drop();
        return got;
    }
    std::size_t write(std::span<const std::uint8_t> bytes) override {
        if (!client_.is_open()) return 0;
        error_code error;
        const std::size_t taken = client_.write_some(boost::asio::buffer(bytes.data(), bytes.size()), error);
        if (error && error != boost::asio::error::would_block) drop();
        return taken;
    }
    bool waits() const override { return true; }

  private:
    void accept() {
        acceptor_.async_accept([this](const error_code& error, tcp::socket caller) {
            if (error == boost::asio::error::operation_aborted) return;
            if (!error && !somebody_there()) {  // a second caller is hung up on
                client_ = std::move(caller);
                error_code ignored;
                client_.non_blocking(true, ignored);
                client_.set_option(tcp::no_delay(true), ignored);
                client_.set_option(tcp::socket::send_buffer_size(kSendBuffer), ignored);
                there_ = true;
                await();
            }
            accept();
        });
    }
    void await() {
        if (!then_ || !client_.is_open() || sends_no_more_) return;
        client_.async_wait(tcp::socket::wait_read, [this](const error_code& error) {
            if (!error && then_) std::exchange(then_, {})();
        });
    }
    /// A client that has left makes room for the next, even if nobody has read so far that it has. One that
    /// only sends no more cannot be known from one that has left until something is written to it.
    bool somebody_there() {
        if (!client_.is_open()) return false;
        if (sends_no_more_) drop();
        if (!client_.is_open()) return false;
        char byte;
        error_code error;
        client_.receive(boost::asio::buffer(&byte, 1), tcp::socket::message_peek, error);
        if (error && error != boost::asio::error::would_block) drop();
        return client_.is_open();
    }
    void drop() {
        there_ = false;
        sends_no_more_ = false;
        error_code ignored;
        client_.shutdown(tcp::socket::shutdown_both, ignored);
        client_.close(ignored);
    }

    tcp::acceptor acceptor_;
    tcp::socket client_;
    std::uint16_t port_ = 0;
    std::function<void()> then_;
    std::atomic<bool> there_{false};
    bool sends_no_more_ = false;
};

}  // namespace

std::unique_ptr<UartEnd> make_tcp_end(std::uint16_t port, const LiveOptions& options) {
    return std::make_unique<LiveEnd>(options, [&](boost::asio::io_context& io) {
        return std::make_unique<TcpClient>(io, options.name, port);
    });
}

}  // namespace puckloop::exec
