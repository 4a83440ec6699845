#pragma once
// A small server of HTTP on 127.0.0.1. Boost.Beast is in its .cpp only: whoever includes it compiles for
// long.

#include "view/answers.h"
#include "view/server/access.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace puckloop::view {

struct ServerLimits {
    std::size_t connections = 64;     ///< more are closed at once
    std::size_t header_bytes = 8192;  ///< of a request
    std::size_t body_bytes = 4096;    ///< of a POST; a GET may have none
    double request_seconds = 15;      ///< for a whole request to come, and idle between two
    double answer_seconds = 60;       ///< for a slow reader to take an answer
    double feed_seconds = 1.0 / 30;   ///< between two messages of a feed, at least
};

class HttpServer {
  public:
    using Get = std::function<std::optional<Content>(std::string_view target)>;
    /// A request that changes something: `done` false is a refusal (409) with its reason as content. Only
    /// pages of this server may ask: the request has to have an Origin.
    struct Posted {
        bool done = false;
        Content content;
    };
    using Post = std::function<std::optional<Posted>(std::string_view target, const std::string& body)>;
    /// What a WebSocket is sent, binary: called again and again while it is open, once the last message has
    /// been taken; empty: there is nothing new.
    using Feed = std::function<std::string()>;
    /// A feed for a WebSocket that is opened at `target`; null: there is none.
    using NewFeed = std::function<Feed(std::string_view target)>;

    /// Listens. `port` 0: any that is free. Throws InputError if it is taken.
    HttpServer(std::uint16_t port, Get get, Post post = {}, NewFeed new_feed = {}, ServerLimits limits = {});
    ~HttpServer();
    HttpServer(const HttpServer&) = delete;
    HttpServer& operator=(const HttpServer&) = delete;

    std::uint16_t port() const;
    /// "http://127.0.0.1:PORT/TOKEN/"
    std::string address() const;
    /// Serves until SIGINT, SIGTERM or SIGHUP.
    void serve();

    struct Counts {
        std::uint64_t answered = 0;
        std::array<std::uint64_t, kRefusals> refused{};
    };
    const Counts& counts() const;

  private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace puckloop::view
