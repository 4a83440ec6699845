#include "view/server/http_server.h"

#include "base/error.h"
#include "view/server/loopback_port.h"
#include "view/server/web_socket.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <set>
#include <utility>

namespace puckloop::view {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;

std::chrono::milliseconds milliseconds(double seconds) {
    return std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * seconds));
}

std::string_view text_of(boost::string_view text) {
    return {text.data(), text.size()};
}

/// What browsers are to keep to: nothing from elsewhere, in no frame, nothing kept.
void add_headers(http::response<http::string_body>& answer, bool own_style, std::uint16_t port) {
    // To browsers of before 2022 a WebSocket of the same server is not 'self'.
    answer.set("Content-Security-Policy",
               fmt::format("default-src 'none'; script-src 'self'; style-src 'self'{0}; "
                           "connect-src 'self' ws://127.0.0.1:{1} ws://localhost:{1}; img-src 'self' data:; "
                           "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
                           own_style ? " 'unsafe-inline'" : "", port));
    answer.set("X-Content-Type-Options", "nosniff");
    answer.set("X-Frame-Options", "DENY");
    answer.set("Referrer-Policy", "no-referrer");
    answer.set("Cross-Origin-Resource-Policy", "same-origin");
    answer.set("Cross-Origin-Opener-Policy", "same-origin");
    answer.set(http::field::cache_control, "no-store");
}

}  // namespace

struct HttpServer::Impl : std::enable_shared_from_this<HttpServer::Impl> {
    class Session;

    Impl(std::uint16_t port, Get answer, Post change, NewFeed feeds, ServerLimits bounds)
        : get(std::move(answer)),
          post(std::move(change)),
          new_feed(std::move(feeds)),
          limits(bounds),
          acceptor(context),
          signals(context, SIGINT, SIGTERM, SIGHUP),
          token(new_token()) {
        acceptor.assign(tcp::v4(), listen_at(port, "--port"));
        access.emplace(token, acceptor.local_endpoint().port());
    }

    void accept();
    void refuse(Refusal refusal) { ++counts.refused[static_cast<std::size_t>(refusal)]; }

    Get get;
    Post post;
    NewFeed new_feed;
    ServerLimits limits;
    asio::io_context context{1};
    tcp::acceptor acceptor;
    asio::signal_set signals;
    std::string token;
    std::optional<Access> access;
    std::set<Session*> sessions;
    Counts counts;
};

class HttpServer::Impl::Session : public std::enable_shared_from_this<Session> {
  public:
    Session(tcp::socket&& socket, std::shared_ptr<Impl> server)
        : stream_(std::move(socket)), server_(std::move(server)), buffer_(server_->limits.header_bytes) {
        server_->sessions.insert(this);
    }
    ~Session() { server_->sessions.erase(this); }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    void read() {
        parser_.emplace();
        parser_->header_limit(static_cast<std::uint32_t>(server_->limits.header_bytes));
        parser_->body_limit(server_->limits.body_bytes);
        stream_.expires_after(milliseconds(server_->limits.request_seconds));
        http::async_read(
            stream_, buffer_, *parser_,
            [self = shared_from_this()](beast::error_code error, std::size_t) { self->came(error); });
    }

  private:
    void came(beast::error_code error) {
        if (error == http::error::end_of_stream || error == beast::error::timeout) return close();
        if (error) {
            server_->refuse(Refusal::Malformed);
            keep_ = false;
            if (error == http::error::header_limit || error == http::error::buffer_overflow)
                return refuse(http::status::request_header_fields_too_large);
            if (error == http::error::body_limit) return refuse(http::status::payload_too_large);
            if (error.category() == make_error_code(http::error::end_of_stream).category())
                return refuse(http::status::bad_request);
            return close();
        }
        const auto& request = parser_->get();
        keep_ = request.keep_alive();
        if (request.count(http::field::host) != 1 || request.count(http::field::origin) > 1)
            return refuse(Refusal::Malformed, http::status::bad_request);
        if (const auto refused = server_->access->check(text_of(request[http::field::host]),
                                                        text_of(request[http::field::origin])))
            return refuse(*refused, http::status::forbidden);
        const auto rest = server_->access->rest_of(text_of(request.target()));
        if (!rest) return refuse(Refusal::Token, http::status::not_found);
        if (beast::websocket::is_upgrade(request)) return feed(*rest);
        if (request.method() == http::verb::post && server_->post) return change(*rest);
        if (request.method() != http::verb::get || !request.body().empty())
            return refuse(Refusal::Method, http::status::method_not_allowed);
        std::optional<Content> content;
        try {
            content = server_->get(*rest);
        } catch (const std::exception& error_of_file) {
            answer_ = {http::status::internal_server_error, 11};
            answer_.set(http::field::content_type, "text/plain; charset=utf-8");
            answer_.body() = error_of_file.what();
            return send();
        }
        if (!content) return refuse(Refusal::Unknown, http::status::not_found);
        ++server_->counts.answered;
        answer_ = {http::status::ok, 11};
        answer_.set(http::field::content_type, content->type);
        answer_.body() = std::move(content->body);
        own_style_ = content->own_style;
        send();
    }

    /// From here on it is a WebSocket, and this session lasts as long.
    void feed(std::string_view rest) {
        const auto& request = parser_->get();
        if (request[http::field::origin].empty()) return refuse(Refusal::Origin, http::status::forbidden);
        Feed next = server_->new_feed ? server_->new_feed(rest) : Feed();
        if (!next) return refuse(Refusal::Unknown, http::status::not_found);
        ++server_->counts.answered;
        serve_web_socket(std::move(stream_), parser_->release(), std::move(next),
                         milliseconds(server_->limits.feed_seconds),
                         [self = shared_from_this()](bool malformed) {
                             if (malformed) self->server_->refuse(Refusal::Malformed);
                         });
    }

    void change(std::string_view rest) {
        if (parser_->get()[http::field::origin].empty())
            return refuse(Refusal::Origin, http::status::forbidden);
        auto posted = server_->post(rest, parser_->get().body());
        if (!posted) return refuse(Refusal::Unknown, http::status::not_found);
        ++server_->counts.answered;
        answer_ = {posted->done ? http::status::ok : http::status::conflict, 11};
        answer_.set(http::field::content_type, posted->content.type);
        answer_.body() = std::move(posted->content.body);
        send();
    }

    void refuse(Refusal refusal, http::status status) {
        server_->refuse(refusal);
        refuse(status);
    }
    void refuse(http::status status) {
        answer_ = {status, 11};
        answer_.set(http::field::content_type, "text/plain; charset=utf-8");
        answer_.body() = "refused\n";
        send();
    }

    void send() {
        add_headers(answer_, std::exchange(own_style_, false), server_->acceptor.local_endpoint().port());
        answer_.keep_alive(keep_);
        answer_.prepare_payload();
        stream_.expires_after(milliseconds(server_->limits.answer_seconds));
        http::async_write(stream_, answer_,
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                              self->answer_.body().clear();
                              self->answer_.body().shrink_to_fit();
                              if (error || !self->keep_) return self->close();
                              self->read();
                          });
    }

    void close() {
        beast::error_code ignored;
        stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    }

    beast::tcp_stream stream_;
    std::shared_ptr<Impl> server_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::string_body>> parser_;
    http::response<http::string_body> answer_;
    bool keep_ = false;
    bool own_style_ = false;  // of the answer
};

void HttpServer::Impl::accept() {
    acceptor.async_accept([self = shared_from_this()](beast::error_code error, tcp::socket socket) {
        if (error == asio::error::operation_aborted) return;
        if (!error) {
            if (self->sessions.size() >= self->limits.connections)
                self->refuse(Refusal::TooMany);  // closed as it goes
            else
                std::make_shared<Session>(std::move(socket), self)->read();
        }
        self->accept();
    });
}

HttpServer::HttpServer(std::uint16_t port, Get get, Post post, NewFeed new_feed, ServerLimits limits)
    : impl_(std::make_shared<Impl>(port, std::move(get), std::move(post), std::move(new_feed), limits)) {}

HttpServer::~HttpServer() = default;

std::uint16_t HttpServer::port() const {
    return impl_->acceptor.local_endpoint().port();
}

std::string HttpServer::address() const {
    return fmt::format("http://127.0.0.1:{}/{}/", port(), impl_->token);
}

void HttpServer::serve() {
    impl_->signals.async_wait([this](beast::error_code error, int) {
        if (!error) impl_->context.stop();
    });
    impl_->accept();
    impl_->context.run();
}

const HttpServer::Counts& HttpServer::counts() const {
    return impl_->counts;
}

}  // namespace puckloop::view
