#include "view/server/web_socket.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>

#include <memory>
#include <utility>

namespace puckloop::view {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

constexpr std::size_t kMostFromPage = 125;  // bytes; a page has nothing to say
constexpr auto kUnanswered = std::chrono::seconds(60);
constexpr auto kHandshake = std::chrono::seconds(15);

class WebSocket : public std::enable_shared_from_this<WebSocket> {
  public:
    using Request = beast::http::request<beast::http::string_body>;

    WebSocket(beast::tcp_stream&& stream, Request request, std::function<std::string()> feed,
              std::chrono::milliseconds pause, std::function<void(bool)> over)
        : socket_(std::move(stream)),
          timer_(socket_.get_executor()),
          request_(std::move(request)),
          feed_(std::move(feed)),
          pause_(pause),
          over_(std::move(over)) {}

    void accept() {
        beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own times
        socket_.set_option(websocket::stream_base::timeout{kHandshake, kUnanswered, true});
        socket_.read_message_max(kMostFromPage);
        socket_.binary(true);
        socket_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
            if (error) return self->end(false);
            self->listen();
            self->send();
        });
    }

  private:
    /// What comes is the end, or an answer to a ping, which is not heard of here.
    void listen() {
        socket_.async_read(heard_, [self = shared_from_this()](beast::error_code error, std::size_t) {
            const bool closed =
                error == websocket::error::closed || error == asio::error::operation_aborted ||
                error.category() == asio::error::get_system_category() ||
                error.category() == asio::error::get_misc_category() || error == beast::error::timeout;
            self->end(!error || !closed);
        });
    }

    void send() {
        if (ended_) return;
        message_ = feed_();
        if (message_.empty()) return wait();
        socket_.async_write(asio::buffer(message_),
                            [self = shared_from_this()](beast::error_code error, std::size_t) {
                                if (error) return self->end(false);
                                self->wait();
                            });
    }

    void wait() {
        timer_.expires_after(pause_);
        timer_.async_wait([self = shared_from_this()](beast::error_code error) {
            if (!error) self->send();
        });
    }

    void end(bool malformed) {
        if (std::exchange(ended_, true)) return;
        timer_.cancel();
        beast::get_lowest_layer(socket_).close();
        std::exchange(over_, nullptr)(malformed);
    }

    // Without compression: it takes half the time to compile, and the bytes stay on this machine.
    websocket::stream<beast::tcp_stream, false> socket_;
    asio::steady_timer timer_;
    Request request_;
    std::function<std::string()> feed_;
    std::chrono::milliseconds pause_;
    std::function<void(bool)> over_;
    beast::flat_buffer heard_;
    std::string message_;
    bool ended_ = false;
};

}  // namespace

void serve_web_socket(beast::tcp_stream&& stream, beast::http::request<beast::http::string_body> request,
                      std::function<std::string()> feed, std::chrono::milliseconds pause,
                      std::function<void(bool malformed)> over) {
    std::make_shared<WebSocket>(std::move(stream), std::move(request), std::move(feed), pause,
                                std::move(over))
        ->accept();
}

}  // namespace puckloop::view
