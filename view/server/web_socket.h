#pragma once
// A WebSocket of a page: it is sent what a feed has, and says nothing itself. Only http_server.cpp includes
// this.

#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include <chrono>
#include <functional>
#include <string>

namespace puckloop::view {

/// Answers the upgrade that `request` asks for and sends what `feed` gives, at least `pause` apart, until the
/// page or the server ends. The next message is asked for when the last one has been taken: a slow reader
/// gets fewer. One that takes nothing for a minute is cut off. A page that sends anything is, too, and `over`
/// hears of it.
void serve_web_socket(boost::beast::tcp_stream&& stream,
                      boost::beast::http::request<boost::beast::http::string_body> request,
                      std::function<std::string()> feed, std::chrono::milliseconds pause,
                      std::function<void(bool malformed)> over);

}  // namespace puckloop::view
